#include "tactus/cli/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr double kSilent_s = 2.0;
constexpr double kBetween_s = 0.2;
constexpr double kLongest_s = 1e6;  ///< a time that says something

std::string leftText(double left_s) {
  if (!(left_s < kLongest_s)) return "";
  if (left_s < 90.0) return fmt::format(", {:.0f} s left", std::ceil(left_s));
  return fmt::format(", {:.0f} min left", std::ceil(left_s / 60.0));
}

double secondsSince(std::chrono::steady_clock::time_point then,
                    std::chrono::steady_clock::time_point now) {
  return std::chrono::duration<double>(now - then).count();
}

}  // namespace

std::string progressText(std::string_view name, double share, double elapsed_s) {
  if (!(elapsed_s >= kSilent_s)) return "";
  return fmt::format("{:<32} {:3.0f} %{}", name, 100.0 * share,
                     leftText(elapsed_s * (1.0 - share) / share));
}

ProgressLine::ProgressLine(const std::string& name)
    : name_(escaped(name)), is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (is_there_) std::fputs("\r\x1b[K", stderr);
}

void ProgressLine::show(double share) {
  if (!is_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (secondsSince(shown_, now) < kBetween_s) return;
  shown_ = now;
  const std::string text = progressText(name_, share, secondsSince(begin_, now));
  if (text.empty()) return;
  is_there_ = true;
  std::fprintf(stderr, "\r%s\x1b[K", text.c_str());
  std::fflush(stderr);
}

}  // namespace tactus
