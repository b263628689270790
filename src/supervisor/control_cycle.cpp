#include "tactus/supervisor/control_cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactus/canopen/cycle_count.h"
#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

/// To switch on, and to come to rest and switch off; far more than drives need.
constexpr double kSwitchingTime_s = 2.0;
/// Between the last setpoint and power off, for the drives to have followed it.
constexpr double kRestTime_s = 0.02;
/// Beyond the drives' own limit, which names the drive: for first feedback and first samples.
constexpr double kFirstFrames_s = 2.0;
/// A ramp takes no longer in any robot that should be left to it.
constexpr double kMaxRamp_s = 30.0;

double brakeTime_s(const HardwareConfig& hardware) {
  return hardware.gpio && hardware.gpio->brake ? hardware.gpio->brake_switching_s : 0.0;
}

double tareTime_s(const HardwareConfig& hardware) {
  double longest_s = 0.0;
  for (const CanTactileConfig& module : hardware.tactile_modules)
    longest_s = std::max(longest_s, module.tare_samples * module.channels.sample_period_s);
  return longest_s;
}

double rampTime_s(const JointLimits& limits) {
  return std::min(kMaxRamp_s,
                  limits.max_velocity.cwiseQuotient(limits.max_acceleration).maxCoeff());
}

ModeConfig modeConfig(const JointLimits& limits, const HardwareConfig& hardware, double period_s) {
  const double boot_s = hardware.canopen.boot_timeout_s + kFirstFrames_s + tareTime_s(hardware);
  ModeConfig config;
  config.brake_cycles = cyclesCovering(brakeTime_s(hardware), period_s);
  config.boot_cycles = cyclesCovering(boot_s, period_s);
  config.enabling_cycles = cyclesCovering(kSwitchingTime_s, period_s) + config.brake_cycles;
  config.retreating_cycles = cyclesCovering(kMaxRetreat_s, period_s);
  // Drives that do not switch off are cut off before this time is over.
  const double stopping_s = rampTime_s(limits) + hardware.canopen.stop_deadline_s;
  config.stopping_cycles = config.enabling_cycles + cyclesCovering(stopping_s, period_s);
  return config;
}

BrakeConfig brakeConfig(const HardwareConfig& hardware, double period_s) {
  BrakeConfig config;
  config.rest_cycles = cyclesCovering(std::max(kRestTime_s, brakeTime_s(hardware)), period_s);
  config.deadline_cycles = cyclesLasting(hardware.canopen.stop_deadline_s, period_s);
  return config;
}

std::array<const char*, kMaxJoints> jointUnits(const SerialChain& chain) {
  std::array<const char*, kMaxJoints> units{};
  for (int joint = 0; joint < chain.size(); ++joint) units[joint] = unitOf(chain.type(joint));
  return units;
}

}  // namespace

ControlCycle::ControlCycle(const ControllerConfig& controller, const HardwareConfig& hardware,
                           double period_s)
    : controller_(controller),
      gains_(controller.gains),
      gain_change_(controller.gains, period_s),
      robot_(hardware, period_s),
      places_(controller.q_start, hardware),
      joint_units_(jointUnits(controller.chain)),
      period_s_(period_s),
      max_late_cycles_(hardware.real_time.max_late_cycles),
      has_enable_line_(hardware.gpio && hardware.gpio->enable),
      mode_config_(modeConfig(controller.limits, hardware, period_s)),
      brake_config_(brakeConfig(hardware, period_s)),
      state_(controller_.initialState()) {
  if (controller.task.commands) tool_orders_.emplace(*controller.task.commands);
  output_.velocity = JointVector::Zero(controller.q_start.size());
  output_.q_desired = controller.q_start;
}

void ControlCycle::update(const CycleInput& input) noexcept {
  if (!has_next_orders_) goOnWithOrders();
  has_next_orders_ = false;
  const double waited_s = state_.waited_s;
  coast(input.missed_cycles);
  robot_.expect(isCommanding(mode_.mode) ? state_.q_desired : output_.q_desired);
  const auto samples_before = input_.tactile;
  robot_.read(input_);
  withholdSamples(input.missed_cycles, samples_before);
  startTares();
  const Mode before = mode_.mode;
  const Fault fault_before = mode_.fault;
  const ModeInput mode_input = modeInput(input, judge(input));
  updateMode(mode_config_, mode_input, mode_);
  way_on_ = tactus::wayOn(mode_config_, mode_input, mode_);
  if (mode_.mode != Mode::kRunning) state_.waited_s = waited_s;
  const bool is_new_fault = mode_.fault != fault_before;
  if (is_new_fault && mode_.fault != judged_.fault) judgeTimeLimit(before);
  if (is_new_fault) noteCulprit(std::max(0, input.missed_cycles));
  report_.mode = mode_.mode;
  report_.fault = mode_.fault;
  control(input, before);
  if (is_new_fault && mode_.fault != Fault::kNone && is_started_) report_.time_s = time_s();
  updateBrakes();
  rememberPlaces();
  const bool is_boot_new = mode_.mode == Mode::kBoot && mode_.cycles_in_mode == 0;
  if (is_boot_new) repeatRefusedTares();
  robot_.command(driveGoal(), is_boot_new || is_first_, output_.q_desired);
  if (mode_.mode == Mode::kOff) {
    robot_.release();
  } else {
    robot_.write(output_.velocity);
  }
  is_first_ = false;
  heartbeat_ = !heartbeat_;
}

void ControlCycle::prepare() noexcept {
  goOnWithOrders();
  has_next_orders_ = true;
  if (!is_started_) return;
  controller_.prepare(gains_, static_cast<double>(nextTaskCycle()) * period_s_, state_, prepared_);
}

/// The drives kept the last command, and samples grew older.
void ControlCycle::coast(int missed_cycles) noexcept {
  if (missed_cycles <= 0) return;
  controller_.coast(missed_cycles, period_s_, state_);
  robot_.coast(missed_cycles);
  if (isCommanding(mode_.mode)) places_.coast();
}

bool ControlCycle::areConfigured() const noexcept {
  if (!robot_.drives().are_configured || !robot_.hasPositions()) return false;
  for (int module = 0; module < modules(); ++module)
    if (!isReady(module)) return false;
  return true;
}

/// A tare is taken once, before the arm has ever moved: afterwards it may rest in contact.
void ControlCycle::startTares() noexcept {
  if (modules() == 0 || mode_.mode != Mode::kBoot) return;
  if (!robot_.drives().are_configured || !robot_.hasPositions()) return;
  for (TactileReceiver& module : robot_.tactileModules())
    if (module.tareState() == TareState::kNone) module.startTare();
}

void ControlCycle::repeatRefusedTares() noexcept {
  if (is_started_) return;
  for (TactileReceiver& module : robot_.tactileModules())
    if (module.tareState() == TareState::kRefused) module.startTare();
}

void ControlCycle::rememberPlaces() noexcept {
  if (!is_started_) return;
  // A start that was broken off has commanded nothing: its drives may never have held the arm.
  const bool is_at_rest = mode_.mode == Mode::kStopping && output_.velocity.isZero(0.0);
  const bool is_commanding = isCommanding(mode_.mode) && !is_at_rest;
  if (is_commanding) places_.command(output_.q_desired, output_.velocity);
  for (int joint = 0; joint < places_.commanded().size(); ++joint) {
    const DriveReport& drive = robot_.drive(joint);
    const bool is_let_go = drive.is_off || drive.is_cut_off || mode_.mode == Mode::kBoot;
    places_.observe(joint, input_.q_measured[joint], robot_.isHolding(joint),
                    is_let_go && !is_commanding);
  }
  // It may have been its feedback that stood still, whatever other drive's fault was the first.
  for (int joint = 0; joint < places_.commanded().size(); ++joint)
    if (robot_.drive(joint).fault == Fault::kFollowingError) places_.doubt(joint);
}

ModeInput ControlCycle::modeInput(const CycleInput& input, Fault fault) noexcept {
  const DrivesReport drives = robot_.drives();
  ModeInput mode;
  mode.fault = fault;
  mode.stop_requested = input.stop_requested;
  mode.has_enable_line = has_enable_line_;
  mode.enable = input.lines.enable && input.lines.is_valid;
  mode.must_go_off = input.lines.must_go_off;
  mode.are_configured = mode_.mode == Mode::kBoot && areConfigured();
  mode.are_enabled = drives.are_enabled;
  mode.are_disabled = drives.are_disabled;
  mode.is_at_rest = output_.velocity.isZero(0.0);
  mode.is_retreat_over = state_.retreat.is_over;
  mode.missed_cycles = std::max(0, input.missed_cycles);
  return mode;
}

void ControlCycle::control(const CycleInput& input, Mode before) noexcept {
  const bool is_running = mode_.mode == Mode::kRunning;
  if (!is_started_ && !is_running) {
    forgetMotionWhileBooting(mode_.mode, before, state_);
    controller_.watchSensors(input_, period_s_, state_);
    output_.q_desired = robot_.hasPositions() ? input_.q_measured : places_.commanded();
    return;
  }
  if (!is_started_) begin();
  missed_cycles_ = is_started_ ? input.missed_cycles : 0;
  cycles_ += is_started_ ? 1 + missed_cycles_ : 0;
  // A pause that stops the arm is no time of its task, or it would make up for that when it goes
  // on.
  const int paused_cycles = is_running ? missed_cycles_ : 0;
  task_cycles_ += is_started_ && before == Mode::kRunning ? 1 + paused_cycles : 0;
  is_started_ = true;
  applyMode(controller_, mode_.mode, before, input_, gains_, state_);
  const bool goes_on = is_running && before != Mode::kRunning;
  if (goes_on && state_.tool_motion) forgetOrders();
  // The way out of joint limits' zones, from where the arm is put, was ahead that of the gains
  // before.
  const bool is_placed = !isCommanding(mode_.mode) || !isCommanding(before);
  if (is_placed || goes_on) prepared_.path_time_s = std::numeric_limits<double>::quiet_NaN();
  controller_.update(input_, gains_, taskTime_s(), period_s_, prepared_, state_, output_);
}

/// As a replay begins, which knows of no sample before. Of these the age is remembered.
void ControlCycle::begin() noexcept {
  for (int module = 0; module < modules(); ++module)
    samples_at_start_[module] = {input_.tactile[module].sequence, sampleAge(module).value};
  state_ = controller_.initialState();
}

void ControlCycle::fill(CycleRecord& record) const noexcept {
  fillRecord(time_s(), input_, gains_, output_, Vector3::Zero(), record);
  record.task_time_s = taskTime_s();
  if (state_.tool_motion) record.tool_motion = state_.tool_motion->plan();
  record.mode = static_cast<std::uint64_t>(mode_.mode);
  record.missed_cycles = static_cast<std::uint64_t>(missed_cycles_);
  if (mode_.fault != Fault::kNone) record.fault = static_cast<std::uint64_t>(mode_.fault);
}

DriveGoal ControlCycle::driveGoal() const noexcept {
  switch (mode_.mode) {
    case Mode::kBoot:
      return DriveGoal::kConfigure;
    case Mode::kEnabling:
    case Mode::kRunning:
    case Mode::kRetreating:
    case Mode::kHolding:
      return DriveGoal::kEnabled;
    case Mode::kStopping:  // of a start cut short nothing has to be held, and no drive gets power
      return mayLetGo(brake_config_, brake_) || !have_brakes_opened_ ? DriveGoal::kDisabled
                                                                     : DriveGoal::kEnabled;
    case Mode::kFault:
      return DriveGoal::kQuickStop;
    case Mode::kReady:
    case Mode::kOff:
      break;
  }
  return DriveGoal::kDisabled;
}

void ControlCycle::updateBrakes() noexcept {
  const DrivesReport drives = robot_.drives();
  BrakeInput input;
  input.are_enabled = drives.are_enabled;
  input.is_any_holding = drives.is_any_holding;
  input.is_any_moving_on = drives.is_any_moving_on;
  input.is_at_rest = output_.velocity.isZero(0.0);
  updateBrake(brake_config_, mode_, input, brake_);
  const bool is_off = mode_.mode == Mode::kBoot || mode_.mode == Mode::kReady;
  have_brakes_opened_ = brake_.is_open || (have_brakes_opened_ && !is_off);
}

GpioOutputs ControlCycle::lines() const noexcept {
  GpioOutputs outputs;
  outputs.release_brake = brake_.is_open;
  outputs.heartbeat = heartbeat_;
  return outputs;
}

}  // namespace tactus
