#include "tactus/commission/stroke.h"

#include <algorithm>
#include <cmath>

#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

// As in the daemon: to switch on, and between the last setpoint and power off.
constexpr double kSwitching_s = 2.0;
constexpr double kRest_s = 0.02;
/// Of the following error that is allowed: further against the command is no noise.
constexpr double kWrongShare = 0.25;
constexpr double kNoise_counts = 4.0;

double brakeTime_s(const HardwareConfig& hardware) {
  return hardware.gpio && hardware.gpio->brake ? hardware.gpio->brake_switching_s : 0.0;
}

ModeConfig modesOf(const HardwareConfig& hardware, const MotionLimits& limits, double period_s) {
  const double ramp_s = 2.0 * (limits.max_speed / limits.max_acceleration +
                               limits.max_acceleration / limits.max_jerk);
  ModeConfig config;
  config.brake_cycles = cyclesCovering(brakeTime_s(hardware), period_s);
  config.boot_cycles = cyclesCovering(hardware.canopen.boot_timeout_s + kSwitching_s, period_s);
  config.enabling_cycles = cyclesCovering(kSwitching_s, period_s) + config.brake_cycles;
  config.stopping_cycles =
      config.enabling_cycles + cyclesCovering(ramp_s + hardware.canopen.stop_deadline_s, period_s);
  return config;
}

BrakeConfig brakesOf(const HardwareConfig& hardware, double period_s) {
  return {cyclesCovering(std::max(kRest_s, brakeTime_s(hardware)), period_s),
          cyclesLasting(hardware.canopen.stop_deadline_s, period_s)};
}

/// The robot that a stroke knows: one drive, counted in units as believed.
HardwareConfig withOneDrive(const HardwareConfig& hardware, const StrokePlan& plan) {
  HardwareConfig one = hardware;
  one.tactile_modules.clear();
  DriveConfig drive = plan.drive;
  drive.joint = 0;
  drive.bus = plan.bus;
  drive.node_id = plan.node_id;
  drive.counts_per_unit = plan.bounds.counts_per_unit;
  drive.offset = 0.0;
  drive.sign = 1;
  drive.tracking_gain_per_s = 0.0;
  drive.max_following_error = plan.bounds.max_following_error;
  drive.max_velocity = plan.bounds.limits.max_speed;
  one.drives = {drive};
  return one;
}

}  // namespace

Stroke::Stroke(const HardwareConfig& hardware, const StrokePlan& plan, double period_s)
    : plan_(plan),
      period_s_(period_s),
      has_enable_line_(hardware.gpio && hardware.gpio->enable),
      robot_(withOneDrive(hardware, plan), period_s),
      mode_config_(modesOf(hardware, plan.bounds.limits, period_s)),
      brake_config_(brakesOf(hardware, period_s)),
      figures_(period_s),
      commanded_(JointVector::Zero(1)),
      velocity_(JointVector::Zero(1)) {
  const double most = plan.bounds.max_travel;
  plan_.shape.distance = std::clamp(plan.shape.distance, -most, most);
}

void Stroke::update(const CommissionInput& input) noexcept {
  if (input.missed_cycles > 0) robot_.coast(input.missed_cycles);
  commanded_[0] += velocity_[0] * period_s_ * (1 + input.missed_cycles);
  robot_.expect(commanded_);
  robot_.read(seen_);
  const Mode before = mode_.mode;
  const bool is_enabled = input.lines.enable && input.lines.is_valid;
  const bool has_begun = before != Mode::kBoot && before != Mode::kReady;
  if (input.stop_requested || (has_begun && !is_enabled)) {
    was_stopped_ = was_stopped_ || !is_over_;
    is_over_ = true;
  }
  ModeInput mode;
  mode.fault = judge(input);
  mode.stop_requested = is_over_ || mode_.fault != Fault::kNone;
  mode.has_enable_line = has_enable_line_;
  mode.enable = is_enabled;
  const DrivesReport drives = robot_.drives();
  mode.are_configured = drives.are_configured && robot_.hasPositions();
  mode.are_enabled = drives.are_enabled;
  mode.are_disabled = drives.are_disabled;
  mode.is_at_rest = velocity_.isZero(0.0);
  mode.missed_cycles = std::max(0, input.missed_cycles);
  updateMode(mode_config_, mode, mode_);
  move(input, before);
  updateBrakes();
  robot_.command(goal(), is_first_, commanded_);
  is_first_ = false;
  if (mode_.mode == Mode::kOff) {
    robot_.release();
  } else {
    robot_.write(velocity_);
  }
  note();
}

Fault Stroke::judge(const CommissionInput& input) noexcept {
  if (mode_.mode == Mode::kFault || mode_.mode == Mode::kOff) return Fault::kNone;
  if (input.lines.emergency_stop) return Fault::kEmergencyStop;
  if (input.are_lines_lost || !input.lines.is_valid) return Fault::kGpioLost;
  if (input.bus_faults[plan_.bus] != Fault::kNone) return input.bus_faults[plan_.bus];
  const DriveReport& drive = robot_.drive(0);
  if (drive.fault != Fault::kNone) {
    report_.detail = drive.detail;
    return drive.fault;
  }
  if (!report_.has_moved) return judgePlace();
  if (mode_.mode != Mode::kRunning && mode_.mode != Mode::kStopping) return Fault::kNone;
  if (runsWrongWay()) {
    report_.end = StrokeEnd::kWrongWay;
    return Fault::kFollowingError;
  }
  const double gap_s = input.missed_cycles * period_s_;
  if (mode_.mode != Mode::kRunning || gap_s <= kMaxGap_s) return Fault::kNone;
  report_.detail = {gap_s, kMaxGap_s, "s"};
  return Fault::kOverrun;
}

/// Hazard: until it moves the command follows the joint, so that no following error tells of one
/// that runs away as its brake opens, or that is pushed to where it must not begin.
Fault Stroke::judgePlace() noexcept {
  if (!robot_.hasPositions()) return Fault::kNone;
  const double counts_per_unit = plan_.bounds.counts_per_unit;
  const double most = std::max(plan_.bounds.max_following_error, kNoise_counts / counts_per_unit);
  const double way = std::abs(robot_.drive(0).position - plan_.rest_counts / counts_per_unit);
  if (way <= most) return Fault::kNone;
  report_.end = StrokeEnd::kMovedAway;
  report_.detail = {way, most, ""};
  return Fault::kNotAtStart;
}

/// Long before the following error is too large.
bool Stroke::runsWrongWay() const noexcept {
  const double least = std::max(kWrongShare * plan_.bounds.max_following_error,
                                kNoise_counts / plan_.bounds.counts_per_unit);
  const double asked = commanded_[0] - start_, gone = robot_.drive(0).position - start_;
  return asked * gone < 0.0 && std::abs(gone) > least;
}

void Stroke::begin() noexcept {
  start_ = origin_ = commanded_[0];
  time_s_ = 0.0;
  report_.has_moved = true;
  motion_ = StrokeMotion(plan_.shape, plan_.bounds.limits);
}

void Stroke::move(const CommissionInput& input, Mode before) noexcept {
  const bool is_moving = mode_.mode == Mode::kRunning || mode_.mode == Mode::kStopping;
  if (!is_moving) {
    velocity_[0] = 0.0;
    const bool has_run = report_.has_moved;
    if (!has_run && robot_.hasPositions()) commanded_[0] = start_ = robot_.drive(0).position;
    return;
  }
  const bool begins = mode_.mode == Mode::kRunning && before != Mode::kRunning;
  if (begins) begin();
  if (!begins) time_s_ += period_s_ * (1 + input.missed_cycles);
  const bool is_cut_short = mode_.mode == Mode::kStopping && before == Mode::kRunning;
  if (is_cut_short && time_s_ < motion_.duration()) {
    const AxisState state = motion_.at(time_s_);
    origin_ += state.p;
    motion_.stopFrom({0.0, state.v, state.a}, plan_.bounds.limits);
    time_s_ = 0.0;
  }
  const AxisState now = motion_.at(time_s_), next = motion_.at(time_s_ + period_s_);
  if (input.missed_cycles > 0) figures_.skip();
  figures_.add(commanded_[0], now.v, robot_.drive(0).position);
  velocity_[0] = (next.p - now.p) / period_s_;
  if (time_s_ >= motion_.duration()) velocity_[0] = 0.0;
  if (mode_.mode == Mode::kRunning && time_s_ >= motion_.duration()) is_over_ = true;
}

DriveGoal Stroke::goal() const noexcept {
  switch (mode_.mode) {
    case Mode::kBoot:
      return DriveGoal::kConfigure;
    case Mode::kEnabling:
    case Mode::kRunning:
      return DriveGoal::kEnabled;
    case Mode::kStopping:  // of a start cut short nothing has to be held, and no drive gets power
      return mayLetGo(brake_config_, brake_) || !has_brake_opened_ ? DriveGoal::kDisabled
                                                                   : DriveGoal::kEnabled;
    case Mode::kFault:
      return DriveGoal::kQuickStop;
    default:
      return DriveGoal::kDisabled;
  }
}

void Stroke::updateBrakes() noexcept {
  const DrivesReport drives = robot_.drives();
  updateBrake(
      brake_config_, mode_,
      {drives.are_enabled, drives.is_any_holding, drives.is_any_moving_on, velocity_.isZero(0.0)},
      brake_);
  has_brake_opened_ = has_brake_opened_ || brake_.is_open;
}

void Stroke::note() noexcept {
  const DriveReport& drive = robot_.drive(0);
  const double counts = std::round(drive.position * plan_.bounds.counts_per_unit);
  if (!report_.has_moved) report_.start_counts = counts;
  report_.end_counts = counts;
  if (mode_.mode != Mode::kOff) report_.drive = drive;
  report_.fault = mode_.fault;
  report_.is_seen_off = drive.is_off;
  report_.values = figures_.values();
  if (!isFinished() || report_.end != StrokeEnd::kNotYet) return;
  const bool has_fault = mode_.fault != Fault::kNone;
  report_.end = has_fault      ? StrokeEnd::kFault
                : was_stopped_ ? StrokeEnd::kStopped
                               : StrokeEnd::kDone;
}

}  // namespace tactus
