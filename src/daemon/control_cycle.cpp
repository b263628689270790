#include "tactus/daemon/control_cycle.h"

#include <algorithm>
#include <cmath>

#include "tactus/daemon/apply_mode.h"

namespace tactus {
namespace {

/// To switch on, and to come to rest and switch off; far more than drives need.
constexpr double kSwitchingTime_s = 2.0;
/// Between the last setpoint and power off, for the drives to have followed it.
constexpr double kRestTime_s = 0.02;
/// Beyond the drives' own limit, which names the drive: for tare and first feedback.
constexpr double kTareTime_s = 2.0;

int wholeCycles(double duration_s, double period_s) {
  return static_cast<int>(std::ceil(duration_s / period_s - 1e-6));
}

double brakeTime_s(const HardwareConfig& hardware) {
  return hardware.gpio && hardware.gpio->brake ? hardware.gpio->brake_switching_s : 0.0;
}

ModeConfig modeConfig(const HardwareConfig& hardware, double period_s) {
  ModeConfig config;
  config.brake_cycles = wholeCycles(brakeTime_s(hardware), period_s);
  config.boot_cycles = wholeCycles(hardware.canopen.boot_timeout_s + kTareTime_s, period_s);
  config.enabling_cycles = wholeCycles(kSwitchingTime_s, period_s) + config.brake_cycles;
  config.stopping_cycles = config.enabling_cycles;
  return config;
}

}  // namespace

ControlCycle::ControlCycle(const Scene& scene)
    : controller_(scene.controller),
      robot_(*scene.hardware, scene.period_s),
      q_start_(scene.controller.q_start),
      start_tolerance_(scene.hardware->start_tolerance),
      period_s_(scene.period_s),
      max_late_cycles_(scene.hardware->real_time.max_late_cycles),
      has_enable_line_(scene.hardware->gpio && scene.hardware->gpio->enable),
      max_rest_cycles_(
          wholeCycles(std::max(kRestTime_s, brakeTime_s(*scene.hardware)), scene.period_s)),
      mode_config_(modeConfig(*scene.hardware, scene.period_s)),
      state_(controller_.initialState()) {
  output_.velocity = JointVector::Zero(q_start_.size());
  output_.q_desired = q_start_;
}

void ControlCycle::update(const CycleInput& input) noexcept {
  robot_.read(input_);
  const Mode before = mode_.mode;
  const Fault fault_before = mode_.fault;
  updateMode(mode_config_, modeInput(input, judge(input)), mode_);
  const bool is_new_fault = mode_.fault != fault_before;
  if (is_new_fault && mode_.fault != judged_.fault) judged_ = {};  // a time limit's
  if (is_new_fault) noteCulprit();
  report_.mode = mode_.mode;
  report_.fault = mode_.fault;
  control(input, before);
  rest_cycles_ = output_.velocity.isZero(0.0) ? std::min(rest_cycles_, max_rest_cycles_) + 1 : 0;
  const bool is_boot_new = mode_.mode == Mode::kBoot && mode_.cycles_in_mode == 0;
  robot_.command(driveGoal(), is_boot_new || is_first_, output_.q_desired);
  if (mode_.mode == Mode::kOff) {
    robot_.release();
  } else {
    robot_.write(output_.velocity);
  }
  is_first_ = false;
  heartbeat_ = !heartbeat_;
}

void ControlCycle::noteCulprit() noexcept {
  report_.joint = judged_.joint;
  report_.bus = judged_.bus;
  if (judged_.joint >= 0) report_.drive = robot_.drive(judged_.joint);
}

Fault ControlCycle::judge(const CycleInput& input) noexcept {
  judged_ = {};
  const auto found = [this](Fault fault) { return (judged_.fault = fault) != Fault::kNone; };
  if (input.lines.emergency_stop && found(Fault::kEmergencyStop)) return judged_.fault;
  if (input.has_forbidden_call && found(Fault::kForbiddenSystemCall)) return judged_.fault;
  if (input.are_lines_lost && found(Fault::kGpioLost)) return judged_.fault;
  if (found(judgeBuses(input)) || found(judgeDrives())) return judged_.fault;
  const bool is_moving = mode_.mode == Mode::kRunning || mode_.mode == Mode::kHolding;
  const bool is_late = mode_.mode != Mode::kBoot && input.late_in_a_row > max_late_cycles_;
  if (is_late && found(Fault::kOverrun)) return judged_.fault;
  if (found(judgeTactile())) return judged_.fault;
  found(is_moving ? output_.fault : Fault::kNone);
  return judged_.fault;
}

Fault ControlCycle::judgeBuses(const CycleInput& input) noexcept {
  const auto fault = std::find_if(input.bus_faults.begin(), input.bus_faults.end(),
                                  [](Fault candidate) { return candidate != Fault::kNone; });
  if (fault == input.bus_faults.end()) return Fault::kNone;
  judged_.bus = static_cast<int>(fault - input.bus_faults.begin());
  return *fault;
}

/// A drive's fault stays until its set-up begins anew, so it says nothing about the present once
/// it has been answered.
Fault ControlCycle::judgeDrives() noexcept {
  if (mode_.mode == Mode::kFault) return Fault::kNone;
  const DrivesReport drives = robot_.drives();
  judged_.joint = drives.joint;
  const bool is_configured_first = mode_.mode == Mode::kBoot && areConfigured();
  if (drives.fault == Fault::kNone && is_configured_first && !isAtStart())
    return Fault::kNotAtStart;
  return drives.fault;
}

Fault ControlCycle::judgeTactile() noexcept {
  TactileReceiver* const tactile = robot_.tactile();
  if (!tactile) return Fault::kNone;
  if (mode_.mode != Mode::kBoot) return tactile->fault();
  if (tactile->tareState() == TareState::kRefused) return Fault::kTareRefused;
  const bool is_late = mode_.cycles_in_mode >= mode_config_.boot_cycles;
  return is_late && robot_.drives().are_configured ? Fault::kTactileStale : Fault::kNone;
}

/// The tare is taken once, before the arm has ever moved: afterwards it may rest in contact.
bool ControlCycle::areConfigured() noexcept {
  if (!robot_.drives().are_configured || !robot_.hasPositions()) return false;
  TactileReceiver* const tactile = robot_.tactile();
  if (!tactile) return true;
  if (tactile->tareState() == TareState::kNone) tactile->startTare();
  return tactile->tareState() == TareState::kDone && tactile->sample().sequence > 0;
}

bool ControlCycle::isAtStart() const noexcept {
  if (is_started_) return true;
  return ((input_.q_measured - q_start_).cwiseAbs().array() <= start_tolerance_).all();
}

ModeInput ControlCycle::modeInput(const CycleInput& input, Fault fault) noexcept {
  const DrivesReport drives = robot_.drives();
  ModeInput mode;
  mode.fault = fault;
  mode.stop_requested = input.stop_requested;
  mode.has_enable_line = has_enable_line_;
  mode.enable = input.lines.enable && input.lines.is_valid;
  mode.are_configured = mode_.mode == Mode::kBoot && areConfigured();
  mode.are_enabled = drives.are_enabled;
  mode.are_disabled = drives.are_disabled;
  mode.is_at_rest = output_.velocity.isZero(0.0);
  return mode;
}

void ControlCycle::control(const CycleInput& input, Mode before) noexcept {
  const bool is_running = mode_.mode == Mode::kRunning;
  if (!is_started_ && !is_running) {
    output_.q_desired = robot_.hasPositions() ? input_.q_measured : q_start_;
    return;
  }
  const int missed = is_started_ ? input.missed_cycles : 0;
  cycles_ += is_started_ ? 1 + missed : 0;
  task_cycles_ += is_started_ && before == Mode::kRunning ? 1 + missed : 0;
  is_started_ = true;
  if (missed > 0) controller_.coast(missed, period_s_, state_);
  applyMode(controller_, mode_.mode, before, input_, state_);
  const double task_time_s = static_cast<double>(task_cycles_) * period_s_;
  controller_.update(input_, task_time_s, period_s_, state_, output_);
  fillRecord(static_cast<double>(cycles_) * period_s_, input_, output_, Vector3::Zero(), record_);
  record_.task_time_s = task_time_s;
  record_.mode = static_cast<std::uint64_t>(mode_.mode);
  if (mode_.fault != Fault::kNone) record_.fault = static_cast<std::uint64_t>(mode_.fault);
}

DriveGoal ControlCycle::driveGoal() const noexcept {
  switch (mode_.mode) {
    case Mode::kBoot:
      return DriveGoal::kConfigure;
    case Mode::kEnabling:
    case Mode::kRunning:
    case Mode::kHolding:
      return DriveGoal::kEnabled;
    case Mode::kStopping:
      return rest_cycles_ > max_rest_cycles_ ? DriveGoal::kDisabled : DriveGoal::kEnabled;
    case Mode::kFault:
      return DriveGoal::kQuickStop;
    case Mode::kReady:
    case Mode::kOff:
      break;
  }
  return DriveGoal::kDisabled;
}

/// Brakes close before the drives let go, and open before they move; only after a quick stop do
/// drives switch off by themselves.
bool ControlCycle::mayMove() const noexcept {
  if (mode_.reaction == Reaction::kBrake) return false;
  switch (mode_.mode) {
    case Mode::kEnabling:
      return robot_.drives().are_enabled;
    case Mode::kRunning:
    case Mode::kHolding:
      return true;
    case Mode::kStopping:
      return rest_cycles_ == 0;
    case Mode::kFault:
      return !robot_.drives().are_disabled;
    default:
      return false;
  }
}

GpioOutputs ControlCycle::lines() const noexcept {
  GpioOutputs outputs;
  outputs.release_brake = mayMove();
  outputs.heartbeat = heartbeat_;
  return outputs;
}

}  // namespace tactus
