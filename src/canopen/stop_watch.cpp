#include "tactus/canopen/stop_watch.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr int kHearing_cycles = 3;  ///< until feedback tells of a command

}  // namespace

void StopWatch::coast(int missed_cycles) noexcept {
  const auto pass = [&](int& cycles) {
    const long long passed = static_cast<long long>(cycles) + missed_cycles;
    const long long latest = deadline_cycles_ - kHearing_cycles;
    if (cycles > 0) cycles = std::max(cycles, static_cast<int>(std::min(passed, latest)));
  };
  pass(quick_stop_cycles_);
  pass(ignored_cycles_);
  rest_watch_.restart();  // nobody knows how far it has come in which time
}

void StopWatch::update(DriveGoal goal, bool ignores, bool is_unheard, int periods_heard,
                       DriveReport& report) noexcept {
  ignored_cycles_ = ignores ? std::min(ignored_cycles_, deadline_cycles_) + 1 : 0;
  if (ignored_cycles_ > deadline_cycles_) latch(Fault::kDriveStateLost, {}, report);
  if (goal != DriveGoal::kQuickStop) {
    rest_watch_.restart();
    quick_stop_cycles_ = 0;
    report.is_moving_on = report.is_cut_off = false;
    return;
  }
  // What it did while nobody heard of it shows as a jump, which is no motion on.
  if (is_unheard) rest_watch_.restart();
  if (!is_unheard && rest_watch_.update(report.position, periods_heard)) report.is_moving_on = true;
  quick_stop_cycles_ = std::min(quick_stop_cycles_, deadline_cycles_) + 1;
  const bool is_late = quick_stop_cycles_ > deadline_cycles_ || report.is_moving_on;
  if (is_late && !report.is_off) report.is_cut_off = true;
}

}  // namespace tactus
