#include "support/command_run.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>

namespace tactus::test {

int runCommand(void (*add)(CLI::App& app, int& exit_code), std::vector<std::string> arguments,
               std::string& output) {
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
