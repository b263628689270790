#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace tactus {

/// Anything wrong with what a user gave: scene, robot, URDF, log, --set. what() is one line:
/// `file:line:col: key: what is wrong, what is expected`. Ends a program with exit code 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One that says where, taken apart for programs that read it. Columns count from 1, in bytes.
struct ErrorPlace {
  std::string file, key;
  int line = 1, column = 1;
  std::string problem, expected;
};
class LocatedError : public InputError {
 public:
  explicit LocatedError(ErrorPlace at) : InputError(line(at)), place(std::move(at)) {}
  ErrorPlace place;

 private:
  static std::string line(const ErrorPlace& at) {
    return at.file + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " +
           at.key + ": " + at.problem + ", " + at.expected;
  }
};

}  // namespace tactus
