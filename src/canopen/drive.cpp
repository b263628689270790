#include "tactus/canopen/drive.h"

#include <algorithm>
#include <cmath>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

/// Operation enabled that was seen for so many cycles is not left but by a command of ours: a
/// control word takes effect with the SYNC after it, is seen in the feedback after the next one,
/// and drives may need a cycle more.
constexpr int kSettledCycles = 3;

/// Feedback of two cycles in one, where the first was late; more is another's.
constexpr int kMostPeriodsHeard = 2;

// What is missing of a silent drive.
constexpr const char* kNoFeedback = "cycles without feedback";
constexpr const char* kNoHeartbeat = "cycles without heartbeat";
constexpr const char* kNeither = "cycles without feedback and heartbeat";

bool isWithoutPower(DriveState state) noexcept {
  return state == DriveState::kNotReady || state == DriveState::kSwitchOnDisabled ||
         state == DriveState::kReadyToSwitchOn || state == DriveState::kFault;
}

bool isInFault(const std::optional<DriveState>& state) noexcept {
  return state == DriveState::kFault || state == DriveState::kFaultReactionActive;
}

PowerGoal powerGoal(DriveGoal goal, bool has_fault) noexcept {
  if (has_fault || goal == DriveGoal::kQuickStop) return PowerGoal::kQuickStop;
  return goal == DriveGoal::kEnabled ? PowerGoal::kEnabled : PowerGoal::kDisabled;
}

}  // namespace

Drive::Drive(const DriveConfig& config, const CanopenConfig& canopen, double period_s)
    : config_(config),
      heartbeat_timeout_cycles_(cyclesLasting(canopen.heartbeat_timeout_s, period_s)),
      answer_timeout_cycles_(cyclesLasting(canopen.sdo_timeout_s, period_s)),
      setup_(config, canopen, period_s),
      velocity_counts_(config.sign * config.counts_per_unit),
      quick_stopped_(period_s),
      stop_watch_(cyclesLasting(canopen.stop_deadline_s, period_s), period_s) {}

void Drive::receive(const CanFrame& frame) noexcept {
  if (frame.kind != FrameKind::kData || frame.extended || frame.is_fd) return;
  switch (frame.id - static_cast<std::uint32_t>(config_.node_id)) {
    case cob_id::kTpdo1:
      return receiveFeedback(frame);
    case cob_id::kHeartbeat:
      return receiveHeartbeat(frame);
    case cob_id::kEmergency:
      return receiveEmergency(frame);
    case cob_id::kSdoAnswer:
      if (frame.size != 8) ++malformed_frames_;
      return setup_.receive(frame);
  }
}

void Drive::receiveFeedback(const CanFrame& frame) noexcept {
  const auto feedback = decodeFeedback(frame, config_.node_id);
  if (!feedback) ++malformed_frames_;
  if (!feedback) return;
  feedback_ = feedback;
  periods_heard_ = std::min(periods_heard_ + 1, kMostPeriodsHeard);
}

void Drive::receiveHeartbeat(const CanFrame& frame) noexcept {
  const auto state = decodeHeartbeat(frame, config_.node_id);
  if (!state) {
    ++malformed_frames_;
    return;
  }
  cycles_without_heartbeat_ = 0;
  is_operational_ = state == NmtState::kOperational;
  has_to_start_ = phase_ == Phase::kStarting && state == NmtState::kPreOperational;
  if (state == NmtState::kBootUp) return onBootUp();
  if (phase_ == Phase::kConfigured && !is_operational_) fail(Fault::kDriveStateLost);
}

void Drive::onBootUp() noexcept {
  if (phase_ == Phase::kConfigured) {
    fail(Fault::kDriveStateLost);
    report_.is_configured = report_.has_state = false;
    report_.state = DriveState::kNotReady;
    beginRestart();  // its mapping is gone, if it is true: setpoints would be misread
  } else if (phase_ == Phase::kRestarting) {
    if (restart_cycles_ == 0) return;  // the reset has not been sent yet
    phase_ = Phase::kUnconfigured;
    report_.is_restarting = report_.is_silent = false;
    report_.is_off = true;
  } else if (phase_ != Phase::kUnconfigured) {
    phase_ = Phase::kSetup;
    setup_.onBootUp();
  }
}

void Drive::receiveEmergency(const CanFrame& frame) noexcept {
  const auto emergency = decodeEmergency(frame, config_.node_id);
  if (!emergency) {
    ++malformed_frames_;
    return;
  }
  report_.emergency_code = emergency->code;
  const bool is_new = phase_ == Phase::kConfigured && !has_old_fault_;
  if (is_new && emergency->code != 0) fail(Fault::kDriveFault, emergencyDetail());
}

void Drive::observe(const CommandedPlace& place) noexcept {
  if (phase_ == Phase::kStarting) awaitOperation();
  if (phase_ == Phase::kRestarting || phase_ == Phase::kUnconfigured) watchRestart();
  if (phase_ == Phase::kConfigured) {
    countSilence();
    takeFeedback();
    watchSilence();
    watchFault();
    watchOperation();
    if (isRunning(goal_)) judgePosition(config_, place, feedback_.has_value(), report_);
  }
  feedback_.reset();
}

void Drive::update(DriveGoal goal, bool restart, double velocity, double position,
                   FrameBatch& out) noexcept {
  goal_ = goal;
  watchStop(goal);
  if (report_.is_cut_off) return cutOff(out);
  if (goal == DriveGoal::kConfigure && restart) startSetup();
  if (goal == DriveGoal::kConfigure) continueSetup(out);
  if (phase_ == Phase::kRestarting && goal != DriveGoal::kSilent) makeRestart(out);
  if (phase_ != Phase::kConfigured) return;
  const bool is_finite = std::isfinite(velocity) && std::isfinite(position);
  if (isRunning(goal) && !is_finite)
    fail(Fault::kCommandNotFinite, {velocity, config_.max_velocity, "m/s or rad/s"});
  const DriveCommand command{controlWord(goal), velocityCounts(goal, velocity, position)};
  if (goal != DriveGoal::kSilent) out.push(commandFrame(config_.node_id, command));
  if (goal == DriveGoal::kQuickStop && hasLeftOperation()) stopNode(out);
}

void Drive::startSetup() noexcept {
  report_ = {};
  phase_ = Phase::kSetup;
  setup_.start();
}

void Drive::continueSetup(FrameBatch& out) noexcept {
  const bool is_new = phase_ == Phase::kUnconfigured && report_.fault == Fault::kNone;
  if (is_new) startSetup();
  if (phase_ == Phase::kStarting) startAgain(out);
  if (phase_ != Phase::kSetup) return;
  setup_.update(out);
  if (setup_.status() == DriveSetup::Status::kDone) {
    phase_ = Phase::kStarting;
    has_to_start_ = false;
    is_operational_ = false;  // whatever was seen before, as in a start cut short by a boot-up
    report_.has_position = false;
    starting_cycles_ = 0;
  } else if (setup_.status() == DriveSetup::Status::kFailed) {
    phase_ = Phase::kUnconfigured;
    report_.setup_failure = setup_.failure();
    fail(Fault::kDriveSetupRefused);
  }
}

/// Whenever its heartbeat says that it has not heard NMT start, which one lost frame suffices for.
void Drive::startAgain(FrameBatch& out) noexcept {
  if (has_to_start_) out.push(nmtFrame({NmtCommand::kStart, config_.node_id}));
  has_to_start_ = false;
}

void Drive::awaitOperation() noexcept {
  takeFeedback();
  if (is_operational_ && report_.has_position) return onConfigured();
  const int limit_cycles = heartbeat_timeout_cycles_ + answer_timeout_cycles_;
  if (++starting_cycles_ <= limit_cycles) return;
  phase_ = Phase::kUnconfigured;
  failSilent(starting_cycles_, limit_cycles,
             report_.has_position ? kNoHeartbeat
             : is_operational_    ? kNoFeedback
                                  : kNeither);
}

void Drive::onConfigured() noexcept {
  phase_ = Phase::kConfigured;
  report_.is_configured = true;
  has_old_fault_ = true;  // until its first valid state shows otherwise
  if (!isInFault(state_)) report_.emergency_code = 0;  // of before, as of a master that had gone
  reset_cycles_ = 0;
}

/// Counts as far as it matters: a drive may be silent for months.
void Drive::countSilence() noexcept {
  const int most = std::max(kMaxSilentCycles, heartbeat_timeout_cycles_) + 1;
  cycles_without_feedback_ = feedback_ ? 0 : std::min(cycles_without_feedback_ + 1, most);
  cycles_without_heartbeat_ = std::min(cycles_without_heartbeat_ + 1, most);
}

void Drive::takeFeedback() noexcept {
  if (!feedback_) return;
  cycles_without_feedback_ = 0;
  state_ = decodeStatusWord(feedback_->status_word);
  report_.state = state_.value_or(DriveState::kNotReady);
  report_.has_state = state_.has_value();
  report_.is_off = state_ && isWithoutPower(*state_);
  report_.has_position = true;
  report_.position =
      feedback_->position / (config_.sign * config_.counts_per_unit) + config_.offset;
  if (state_ != DriveState::kQuickStopActive) return quick_stopped_.restart();
  quick_stopped_.update(report_.position);
}

void Drive::watchSilence() noexcept {
  const bool lacks_feedback = cycles_without_feedback_ > kMaxSilentCycles;
  const bool lacks_heartbeat = cycles_without_heartbeat_ > heartbeat_timeout_cycles_;
  report_.is_silent = lacks_feedback;  // else it is seen to hold, or to be off
  if (lacks_feedback)
    failSilent(cycles_without_feedback_, kMaxSilentCycles, kNoFeedback);
  else if (lacks_heartbeat)
    failSilent(cycles_without_heartbeat_, heartbeat_timeout_cycles_, kNoHeartbeat);
}

void Drive::watchFault() noexcept {
  const bool is_in_fault = isInFault(state_);
  if (state_ && !is_in_fault) has_old_fault_ = false;
  if (!is_in_fault) return;
  const bool may_reset = goal_ == DriveGoal::kEnabled && has_old_fault_;
  if (may_reset) ++reset_cycles_;
  const bool is_given_up = reset_cycles_ > (may_reset ? answer_timeout_cycles_ : 0);
  if (!has_old_fault_ || is_given_up) fail(Fault::kDriveFault, emergencyDetail());
}

void Drive::watchOperation() noexcept {
  const bool is_running = isRunning(goal_);
  const bool is_asked_for = goal_ == DriveGoal::kEnabled;
  if (is_asked_for && !is_running && enabled_cycles_ >= kSettledCycles)
    fail(Fault::kDriveStateLost);
  enabled_cycles_ = is_running ? std::min(enabled_cycles_ + 1, kSettledCycles) : 0;
}

bool Drive::isRunning(DriveGoal goal) const noexcept {
  return goal == DriveGoal::kEnabled && report_.fault == Fault::kNone &&
         state_ == DriveState::kOperationEnabled;
}

std::uint16_t Drive::controlWord(DriveGoal goal) const noexcept {
  const bool has_fault = report_.fault != Fault::kNone;
  const bool is_resetting = goal == DriveGoal::kEnabled && has_old_fault_ && !has_fault;
  if (is_resetting && state_ == DriveState::kFault) return control_word::kFaultReset;
  if (!state_) return control_word::kQuickStop;
  // Nobody has told it to stop: it stays there by itself, and only this leads on.
  const bool is_nobodys = goal == DriveGoal::kEnabled || goal == DriveGoal::kConfigure;
  const bool is_to_leave = is_nobodys && !has_fault && quick_stopped_.isStill();
  if (is_to_leave) return control_word::kDisableVoltage;
  return controlWordTowards(powerGoal(goal, has_fault), *state_);
}

std::int32_t Drive::velocityCounts(DriveGoal goal, double velocity, double position) noexcept {
  if (!isRunning(goal)) {
    velocity_counts_.reset();
    return 0;
  }
  return velocity_counts_.next(trackingVelocity(config_, velocity, position, report_.position));
}

void Drive::failSilent(int cycles, int limit, const char* what) noexcept {
  fail(Fault::kDriveSilent, {static_cast<double>(cycles), static_cast<double>(limit), what});
}

void Drive::fail(Fault fault, const FaultDetail& detail) noexcept { latch(fault, detail, report_); }

/// Nothing without an EMCY: the status word tells no reason.
FaultDetail Drive::emergencyDetail() const noexcept {
  if (report_.emergency_code == 0) return {};
  return {.value = static_cast<double>(report_.emergency_code), .unit = "emergency code"};
}

}  // namespace tactus
