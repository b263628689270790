#pragma once

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

namespace tactus::test {

/// Runs the command that `add` adds, by its name and arguments; returns its exit code. What it
/// printed is in `output`, also where it throws.
inline int runCommand(void (*add)(CLI::App& app, int& exit_code),
                      std::vector<std::string> arguments, std::string& output) {
  CLI::App app;
  int exit_code = -1;
  add(app, exit_code);
  std::reverse(arguments.begin(), arguments.end());
  ::testing::internal::CaptureStdout();
  try {
    app.parse(arguments);
  } catch (...) {
    output = ::testing::internal::GetCapturedStdout();
    throw;
  }
  output = ::testing::internal::GetCapturedStdout();
  return exit_code;
}

}  // namespace tactus::test
