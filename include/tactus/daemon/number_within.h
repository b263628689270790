#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace tactus {

/// Of an option that is a number: in [least, most], so finite, which CLI::Range does not ask for:
/// it lets NaN through.
CLI::Validator numberWithin(double least, double most);

}  // namespace tactus
