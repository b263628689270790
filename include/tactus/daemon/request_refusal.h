#pragma once

#include <string>

namespace tactus {

/// Throws the InputError of what is wrong with a request itself.
[[noreturn]] void refuseRequest(const std::string& problem, const std::string& expectation);

}  // namespace tactus
