#pragma once

#include <string>
#include <vector>

#include "tactus/cli/commands.h"

namespace tactus::test {

/// Runs the command that `add` adds, by its name and arguments; returns its exit code. What it
/// printed is in `output`, also where it throws.
int runCommand(void (*add)(CLI::App& app, int& exit_code), std::vector<std::string> arguments,
               std::string& output);

}  // namespace tactus::test
