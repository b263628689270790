#pragma once

#include <string>
#include <vector>

namespace tactus {

struct ChildResult {
  int exit_code = 127;  ///< 127: not started; -1: ended by a signal
  std::string errors;   ///< what it wrote to standard error
};

/// Runs a program, found by PATH unless it has a slash, to its end; its standard output is dropped.
ChildResult runProgram(const std::vector<std::string>& command);

}  // namespace tactus
