#pragma once

#include <cstddef>

namespace tactus {

/// Memory for the stack of one thread: touched, so that no depth of calls faults, above a page that
/// ends the process when the stack overflows. Has to outlive the thread.
class ThreadStack {
 public:
  /// Rounded up to whole pages. Throws std::system_error.
  explicit ThreadStack(std::size_t bytes);
  ~ThreadStack();
  ThreadStack(const ThreadStack&) = delete;
  ThreadStack& operator=(const ThreadStack&) = delete;

  void* lowest() const noexcept { return static_cast<char*>(mapping_) + guard_bytes_; }
  std::size_t size_bytes() const noexcept { return mapped_bytes_ - guard_bytes_; }

 private:
  std::size_t guard_bytes_ = 0;
  std::size_t mapped_bytes_ = 0;
  void* mapping_ = nullptr;
};

}  // namespace tactus
