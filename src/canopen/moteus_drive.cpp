#include "tactus/canopen/moteus_drive.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

using CommandKind = MoteusCommand::Kind;

/// Slower is rest, turns of the output shaft a second times 2 pi: rad/s, or m/s of a spindle.
constexpr double kRestingVelocity = 0.01;
constexpr int kRestingCycles = 5;
/// A command is seen in the reply of the next cycle, and one may be late.
constexpr int kSettledAfter_cycles = 3;
constexpr int kMostReplies = 2;

/// None for modes that nobody here asks for.
std::optional<DriveState> stateOf(int mode) noexcept {
  switch (static_cast<MoteusMode>(mode)) {
    case MoteusMode::kStopped:
      return DriveState::kSwitchOnDisabled;
    case MoteusMode::kFault:
      return DriveState::kFault;
    case MoteusMode::kEnabling:
    case MoteusMode::kCalibrating:
    case MoteusMode::kCalibrationComplete:
      return DriveState::kSwitchedOn;
    case MoteusMode::kPosition:
      return DriveState::kOperationEnabled;
    case MoteusMode::kTimeout:
    case MoteusMode::kZeroVelocity:
    case MoteusMode::kBrake:
      return DriveState::kQuickStopActive;
  }
  return std::nullopt;
}

}  // namespace

MoteusDrive::MoteusDrive(const DriveConfig& config, const CanopenConfig& canopen, double period_s)
    : config_(config),
      watchdog_s_(static_cast<float>(canopen.heartbeat_timeout_s)),
      boot_timeout_cycles_(cyclesLasting(canopen.boot_timeout_s, period_s)),
      still_watch_(period_s),
      stop_watch_(cyclesLasting(canopen.stop_deadline_s, period_s), period_s) {
  if (!(watchdog_s_ > 0.0F))
    throw std::invalid_argument("heartbeat_timeout_s: the drive's watchdog needs a time above 0");
}

void MoteusDrive::receive(const CanFrame& frame) noexcept {
  if (!isMoteusReply(frame, config_.node_id)) return;
  const auto reply = decodeMoteusReply(frame, config_.node_id);
  if (!reply) {
    ++malformed_frames_;
    return;
  }
  reply_ = reply;
  periods_heard_ = std::min(periods_heard_ + 1, kMostReplies);
}

void MoteusDrive::coast(int missed_cycles) noexcept { stop_watch_.coast(missed_cycles); }

void MoteusDrive::observe(const CommandedPlace& place) noexcept {
  countSilence();
  takeReply();
  if (phase_ == Phase::kSetup) judgeSetup();
  if (phase_ == Phase::kConfigured) judgeOperation(place);
  reply_.reset();
}

void MoteusDrive::update(DriveGoal goal, bool restart, double velocity, double position,
                         FrameBatch& out) noexcept {
  goal_ = goal;
  is_asked_ = false;
  watchStop(goal);
  const bool is_new = phase_ == Phase::kUnconfigured && report_.fault == Fault::kNone;
  if (goal == DriveGoal::kConfigure && (restart || is_new)) startSetup();
  if (goal == DriveGoal::kSilent || report_.is_cut_off || phase_ == Phase::kUnconfigured) return;
  if (isRunning(goal) && !(std::isfinite(velocity) && std::isfinite(position)))
    fail(Fault::kCommandNotFinite, {velocity, config_.max_velocity, "m/s or rad/s"});
  out.push(moteusCommandFrame(config_.node_id, command(goal, velocity, position)));
  is_asked_ = true;
}

void MoteusDrive::release(FrameBatch& out) const noexcept {
  if (report_.is_off) out.push(moteusCommandFrame(config_.node_id, {.kind = CommandKind::kStop}));
}

void MoteusDrive::startSetup() noexcept {
  report_ = {};
  last_.reset();
  phase_ = Phase::kSetup;
  setup_cycles_ = silent_cycles_ = resting_cycles_ = enabled_cycles_ = 0;
  still_watch_.restart();
}

void MoteusDrive::judgeSetup() noexcept {
  const bool is_ready = reply_ && last_->map == kMoteusMap && isHome() && last_->fault == 0 &&
                        report_.state == DriveState::kSwitchOnDisabled && report_.has_position;
  if (is_ready) {
    phase_ = Phase::kConfigured;
    report_.is_configured = true;
    return;
  }
  if (++setup_cycles_ > boot_timeout_cycles_) refuseSetup();
}

/// A position that refers to less is another one after the power was off.
bool MoteusDrive::isHome() const noexcept {
  return last_->home.value_or(0) >= static_cast<std::int32_t>(config_.home);
}

/// Names the register that was not as it has to be.
void MoteusDrive::refuseSetup() noexcept {
  phase_ = Phase::kUnconfigured;
  SetupFailure& failure = report_.setup_failure;
  const auto blame = [&failure](std::uint16_t number, std::int32_t value, std::int32_t expected) {
    failure = {number,
               0,
               0,
               true,
               static_cast<std::uint32_t>(value),
               static_cast<std::uint32_t>(expected)};
  };
  if (last_ && !last_->map)
    failure = {moteus_register::kMapVersion, 0, 0};
  else if (last_ && last_->map != kMoteusMap)
    blame(moteus_register::kMapVersion, *last_->map, kMoteusMap);
  else if (last_ && !isHome())
    blame(moteus_register::kHome, last_->home.value_or(0), static_cast<std::int32_t>(config_.home));
  else if (last_ && last_->fault != 0)
    blame(moteus_register::kFault, last_->fault, 0);
  else if (last_ && report_.state != DriveState::kSwitchOnDisabled)
    blame(moteus_register::kMode, last_->mode, 0);
  else
    failure = {moteus_register::kPosition, 0, 0};
  fail(Fault::kDriveSetupRefused);
}

/// In cycles in which a reply was asked for, up to where it matters.
void MoteusDrive::countSilence() noexcept {
  if (reply_)
    silent_cycles_ = 0;
  else if (is_asked_)
    silent_cycles_ = std::min(silent_cycles_ + 1, kMaxSilentCycles + 1);
  report_.is_silent = phase_ == Phase::kConfigured && silent_cycles_ > kMaxSilentCycles;
}

void MoteusDrive::takeReply() noexcept {
  if (!reply_ || phase_ == Phase::kUnconfigured) return;
  if (last_ && !reply_->map) reply_->map = last_->map;
  if (last_ && !reply_->home) reply_->home = last_->home;
  last_ = reply_;
  const auto state = stateOf(reply_->mode);
  report_.has_state = state.has_value();
  report_.state = state.value_or(DriveState::kNotReady);
  report_.is_off = state == DriveState::kSwitchOnDisabled || state == DriveState::kFault;
  if (state == DriveState::kFault)
    report_.emergency_code = static_cast<std::uint16_t>(reply_->fault);
  takePosition(*reply_);
}

/// What is no number is no position: the last one stays.
void MoteusDrive::takePosition(const MoteusReply& reply) noexcept {
  const double scale = config_.sign * config_.counts_per_unit;
  const bool is_slow = std::abs(reply.velocity / scale) < kRestingVelocity;
  resting_cycles_ = is_slow ? std::min(resting_cycles_ + 1, kRestingCycles) : 0;
  if (!std::isfinite(reply.position) || !std::isfinite(reply.velocity)) return;
  report_.position = reply.position / scale + config_.offset;
  report_.has_position = true;
  still_watch_.update(report_.position);
}

void MoteusDrive::judgeOperation(const CommandedPlace& place) noexcept {
  if (report_.is_silent)
    fail(Fault::kDriveSilent, {static_cast<double>(silent_cycles_),
                               static_cast<double>(kMaxSilentCycles), "cycles without reply"});
  if (reply_ && (report_.state == DriveState::kFault || !std::isfinite(reply_->position) ||
                 !std::isfinite(reply_->velocity)))
    fail(Fault::kDriveFault, {.value = static_cast<double>(reply_->fault), .unit = "fault code"});
  const bool is_running = isRunning(goal_);
  if (goal_ == DriveGoal::kEnabled && !is_running && enabled_cycles_ >= kSettledAfter_cycles)
    fail(Fault::kDriveStateLost);
  enabled_cycles_ = is_running ? std::min(enabled_cycles_ + 1, kSettledAfter_cycles) : 0;
  if (is_running) judgePosition(config_, place, reply_.has_value(), report_);
}

void MoteusDrive::watchStop(DriveGoal goal) noexcept {
  const bool ignores = goal == DriveGoal::kDisabled && phase_ == Phase::kConfigured &&
                       report_.state == DriveState::kOperationEnabled;
  const bool is_unheard = silent_cycles_ > kMaxSilentCycles || !report_.has_position;
  stop_watch_.update(goal, ignores, is_unheard, std::exchange(periods_heard_, 0), report_);
}

bool MoteusDrive::isRunning(DriveGoal goal) const noexcept {
  return goal == DriveGoal::kEnabled && phase_ == Phase::kConfigured &&
         report_.fault == Fault::kNone && report_.state == DriveState::kOperationEnabled;
}

MoteusCommand MoteusDrive::command(DriveGoal goal, double velocity, double position) noexcept {
  MoteusCommand command{.watchdog_s = watchdog_s_, .asks_for_setup = phase_ == Phase::kSetup};
  const bool is_to_run =
      goal == DriveGoal::kEnabled && phase_ == Phase::kConfigured && report_.fault == Fault::kNone;
  if (is_to_run) still_watch_.restart();  // it may have begun to move just now
  command.kind = is_to_run ? CommandKind::kVelocity : stopping();
  if (isRunning(goal)) command.velocity = turnsPerSecond(velocity, position);
  return command;
}

/// A fault that came in operation stays, as it would be cleared by stopping.
MoteusCommand::Kind MoteusDrive::stopping() const noexcept {
  if (!last_) return CommandKind::kQuery;
  if (report_.state == DriveState::kFault)
    return phase_ == Phase::kSetup ? CommandKind::kStop : CommandKind::kQuery;
  const bool has_torque = report_.state != DriveState::kSwitchOnDisabled;
  // A velocity that is measured by the encoder's noise is never as slow.
  const bool is_resting = resting_cycles_ >= kRestingCycles || still_watch_.isStill();
  return has_torque && !is_resting ? CommandKind::kZeroVelocity : CommandKind::kStop;
}

float MoteusDrive::turnsPerSecond(double velocity, double position) const noexcept {
  const double tracking = trackingVelocity(config_, velocity, position, report_.position);
  return static_cast<float>(config_.sign * config_.counts_per_unit * tracking);
}

void MoteusDrive::fail(Fault fault, const FaultDetail& detail) noexcept {
  latch(fault, detail, report_);
}

}  // namespace tactus
