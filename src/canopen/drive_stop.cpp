#include <algorithm>
#include <utility>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/drive.h"

/// How a drive is brought to rest whatever it says: deadlines, NMT stop and silence; and how one
/// starts anew whose set-up is gone.
namespace tactus {
namespace {

constexpr int kStopPeriod_cycles = 5;  ///< between NMT stop commands
constexpr int kHearing_cycles = 3;     ///< until feedback tells of a command

}  // namespace

/// What it did meanwhile is heard in the next cycles, which therefore remain.
void Drive::coast(int missed_cycles) noexcept {
  const auto pass = [&](int& cycles) {
    const long long passed = static_cast<long long>(cycles) + missed_cycles;
    const long long latest = stop_deadline_cycles_ - kHearing_cycles;
    if (cycles > 0) cycles = std::max(cycles, static_cast<int>(std::min(passed, latest)));
  };
  pass(quick_stop_cycles_);
  pass(ignored_cycles_);
  rest_watch_.restart();  // nobody knows how far it has come in which time
}

void Drive::release(FrameBatch& out) const noexcept {
  const NmtCommand command =
      report_.is_off ? NmtCommand::kResetCommunication : NmtCommand::kResetNode;
  out.push(nmtFrame({command, config_.node_id}));
}

void Drive::beginRestart() noexcept {
  phase_ = Phase::kRestarting;
  restart_cycles_ = 0;
  report_.is_restarting = true;
  report_.is_off = report_.is_silent = false;
}

/// A drive that has started anew sends no feedback before it is told to.
void Drive::watchRestart() noexcept {
  countSilence();
  if (phase_ == Phase::kUnconfigured) {
    if (report_.is_off && feedback_) beginRestart();
    return;
  }
  report_.is_silent =
      std::min(cycles_without_feedback_, cycles_without_heartbeat_) > heartbeat_timeout_cycles_;
}

/// Once, and again where it is heard although it should be booting.
void Drive::makeRestart(FrameBatch& out) noexcept {
  const bool is_heard = cycles_without_heartbeat_ <= 1 || cycles_without_feedback_ == 0;
  const bool has_ignored = restart_cycles_ > answer_timeout_cycles_ && is_heard;
  if (restart_cycles_ == 0 || has_ignored) {
    out.push(nmtFrame({NmtCommand::kResetNode, config_.node_id}));
    restart_cycles_ = 0;
  }
  restart_cycles_ = std::min(restart_cycles_, answer_timeout_cycles_) + 1;
}

void Drive::watchStop(DriveGoal goal) noexcept {
  const bool ignores = goal == DriveGoal::kDisabled && phase_ == Phase::kConfigured &&
                       state_ == DriveState::kOperationEnabled;
  ignored_cycles_ = ignores ? std::min(ignored_cycles_, stop_deadline_cycles_) + 1 : 0;
  if (ignored_cycles_ > stop_deadline_cycles_) fail(Fault::kDriveStateLost);
  const int periods = std::exchange(periods_heard_, 0);
  if (goal != DriveGoal::kQuickStop) {
    rest_watch_.restart();
    quick_stop_cycles_ = cut_off_cycles_ = 0;
    report_.is_moving_on = report_.is_cut_off = false;
    return;
  }
  // What it did while nobody heard of it shows as a jump, which is no motion on.
  const bool is_unheard = cycles_without_feedback_ > kMaxSilentCycles || !report_.has_position;
  if (is_unheard) rest_watch_.restart();
  if (!is_unheard && rest_watch_.update(report_.position, periods)) report_.is_moving_on = true;
  quick_stop_cycles_ = std::min(quick_stop_cycles_, stop_deadline_cycles_) + 1;
  const bool is_late = quick_stop_cycles_ > stop_deadline_cycles_ || report_.is_moving_on;
  if (is_late && !report_.is_off) report_.is_cut_off = true;
}

void Drive::cutOff(FrameBatch& out) noexcept {
  if (cut_off_cycles_ % kStopPeriod_cycles == 0)
    out.push(nmtFrame({NmtCommand::kStop, config_.node_id}));
  cut_off_cycles_ = std::min(cut_off_cycles_, kCuttingOffCycles) + 1;
}

}  // namespace tactus
