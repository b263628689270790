#pragma once

#include <stdexcept>

namespace tactus {

/// Something that went wrong while running although the input was good: a full disk, a lost file.
/// what() is one line. Ends a program with exit code 3.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactus
