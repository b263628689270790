#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace tactus {

/// How far something has come, 0 to 1, and how long it will still take if it goes on like that.
/// Empty within the first two seconds, in which most things are done.
std::string progressText(std::string_view name, double share, double elapsed_s);

/// Keeps one line of a terminal on standard error up to date; says nothing elsewhere.
class ProgressLine {
 public:
  explicit ProgressLine(const std::string& name);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// May be called as often as one likes.
  void show(double share);

 private:
  using Clock = std::chrono::steady_clock;

  std::string name_;
  bool is_terminal_;
  bool is_there_ = false;
  Clock::time_point begin_ = Clock::now(), shown_ = begin_;
};

}  // namespace tactus
