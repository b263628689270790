#include <algorithm>
#include <utility>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/drive.h"

/// How a drive is brought to rest whatever it says: deadlines, NMT stop and silence; and how one
/// starts anew whose set-up is gone.
namespace tactus {
namespace {

constexpr int kStopPeriod_cycles = 5;  ///< between NMT stop commands

}  // namespace

void Drive::coast(int missed_cycles) noexcept { stop_watch_.coast(missed_cycles); }

/// Off is what it was before the last commands: one of them may have switched it on since. Hazard:
/// one that is not heard may still be slowing down, which a reset would end: it would roll on.
void Drive::release(FrameBatch& out) const noexcept {
  const bool stays_off = report_.is_off && goal_ != DriveGoal::kEnabled;
  const bool may_brake = phase_ == Phase::kConfigured && report_.is_silent && !report_.is_cut_off;
  const NmtCommand command = stays_off   ? NmtCommand::kResetCommunication
                             : may_brake ? NmtCommand::kStop
                                         : NmtCommand::kResetNode;
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
  const bool is_unheard = cycles_without_feedback_ > kMaxSilentCycles || !report_.has_position;
  stop_watch_.update(goal, ignores, is_unheard, std::exchange(periods_heard_, 0), report_);
  if (goal != DriveGoal::kQuickStop) cut_off_cycles_ = stop_node_cycles_ = 0;
}

void Drive::cutOff(FrameBatch& out) noexcept {
  stopNode(out);
  cut_off_cycles_ = std::min(cut_off_cycles_, kCuttingOffCycles) + 1;
}

/// One heartbeat that says so may be a broken one, as long as there is feedback.
bool Drive::hasLeftOperation() const noexcept {
  return !is_operational_ && cycles_without_feedback_ > kMaxSilentCycles;
}

/// Hazard: out of operational a drive obeys no PDO, so no quick stop either, and may go on as it
/// is. NMT stop is what its own watch (6007) reacts to.
void Drive::stopNode(FrameBatch& out) noexcept {
  if (stop_node_cycles_ == 0) out.push(nmtFrame({NmtCommand::kStop, config_.node_id}));
  stop_node_cycles_ = (stop_node_cycles_ + 1) % kStopPeriod_cycles;
}

}  // namespace tactus
