#pragma once

#include <stdexcept>

namespace tactus {

/// Anything wrong with what a user gave: scene, robot, URDF, log, --set. what() is one line:
/// `file:line:col: key: what is wrong, what is expected`. Ends a program with exit code 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactus
