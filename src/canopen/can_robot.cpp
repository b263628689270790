#include "tactus/canopen/can_robot.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/cycle_count.h"
#include "tactus/canopen/visit_kind.h"

namespace tactus {
namespace {

/// A drive that has gone silent cannot be seen to be off: its own heartbeat watch stops it.
bool isReachable(const DriveReport& report) noexcept {
  return (report.is_configured || report.is_restarting) && !report.is_silent;
}

bool holds(DriveState state) noexcept {
  return state == DriveState::kOperationEnabled || state == DriveState::kQuickStopActive ||
         state == DriveState::kFaultReactionActive;
}

bool mayHold(const DriveReport& report) noexcept {
  return !report.has_state || holds(report.state);
}

bool isPowered(const DriveReport& report) noexcept {
  return isReachable(report) && (mayHold(report) || report.state == DriveState::kSwitchedOn);
}

const DriveReport& reportOf(const AnyDrive& drive) noexcept {
  return visitKind([](const auto& it) -> const DriveReport& { return it.report(); }, drive);
}

int busOf(const AnyDrive& drive) noexcept {
  return visitKind([](const auto& it) { return it.bus(); }, drive);
}

}  // namespace

CanRobot::CanRobot(const HardwareConfig& hardware, double period_s)
    : outboxes_(hardware.buses.size()),
      has_canopen_(hardware.buses.size(), false),
      heartbeat_(heartbeatFrame(hardware.canopen.master_node_id, NmtState::kOperational)),
      cycles_a_heartbeat_(cyclesWithin(hardware.canopen.heartbeat_period_s, period_s)),
      places_(JointVector::Zero(static_cast<int>(hardware.drives.size()))) {
  drives_.reserve(hardware.drives.size());
  for (const DriveConfig& drive : hardware.drives) {
    drives_.push_back(makeDrive(drive, hardware.canopen, period_s));
    if (drive.kind == DriveKind::kCia402) has_canopen_[drive.bus] = true;
  }
  for (const CanTactileConfig& module : hardware.tactile_modules)
    tactile_modules_.emplace_back(module, period_s);
}

int probeCycles(const CanopenConfig& canopen, double period_s) noexcept {
  constexpr int kLeast = 100;
  constexpr double kLonger = 1.5;
  return std::max(kLeast, cyclesCovering(kLonger * canopen.heartbeat_timeout_s, period_s));
}

void CanRobot::receive(int bus, std::span<const CanFrame> frames) noexcept {
  for (const CanFrame& frame : frames) {
    for (AnyDrive& drive : drives_) {
      if (busOf(drive) == bus) visitKind([&](auto& it) { it.receive(frame); }, drive);
    }
    for (TactileReceiver& module : tactile_modules_) {
      if (module.bus() == bus) module.receive(frame);
    }
  }
}

void CanRobot::coast(int missed_cycles) noexcept {
  cycles_to_heartbeat_ = std::max(0, cycles_to_heartbeat_ - missed_cycles);
  places_.coast();
  for (AnyDrive& drive : drives_) visitKind([&](auto& it) { it.coast(missed_cycles); }, drive);
}

void CanRobot::read(RobotInput& input) noexcept {
  input.q_measured.resize(static_cast<int>(drives_.size()));
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const int joint = static_cast<int>(i);
    visitKind([&](auto& it) { it.observe(places_.at(joint)); }, drives_[i]);
    input.q_measured[joint] = drive(joint).position;
  }
  for (std::size_t i = 0; i < tactile_modules_.size(); ++i) {
    tactile_modules_[i].tick();
    // One that the module says is none is not worth more than silence.
    if (tactile_modules_[i].fault() == Fault::kNone)
      input.tactile[i] = tactile_modules_[i].sample();
  }
}

void CanRobot::command(DriveGoal goal, bool is_restart, const JointVector& q) noexcept {
  goal_ = goal;
  is_restart_ = is_restart;
  places_.command(q);
}

void CanRobot::write(const JointVector& velocity_setpoint) noexcept {
  const bool is_heartbeat_due = cycles_to_heartbeat_ == 0;
  cycles_to_heartbeat_ = (is_heartbeat_due ? cycles_a_heartbeat_ : cycles_to_heartbeat_) - 1;
  for (std::size_t bus = 0; bus < outboxes_.size(); ++bus) {
    outboxes_[bus].clear();
    has_heartbeat_[bus] = has_canopen_[bus] && (is_heartbeat_due || is_heartbeat_owed_[bus]);
    is_heartbeat_owed_[bus] = false;
    if (has_heartbeat_[bus]) outboxes_[bus].push(heartbeat_);
  }
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const int joint = static_cast<int>(i);
    FrameBatch& outbox = outboxes_[busOf(drives_[i])];
    visitKind(
        [&](auto& it) {
          it.update(goal_, is_restart_, velocity_setpoint[joint], placeToTrack(joint), outbox);
        },
        drives_[i]);
  }
  for (std::size_t bus = 0; bus < outboxes_.size(); ++bus) {
    if (has_canopen_[bus]) outboxes_[bus].push(syncFrame());
  }
  for (const AnyDrive& drive : drives_) {
    const bool needs_silence = visitKind([](const auto& it) { return it.needsSilence(); }, drive);
    if (needs_silence) outboxes_[busOf(drive)].clear();
  }
}

void CanRobot::release() noexcept {
  for (FrameBatch& outbox : outboxes_) outbox.clear();
  for (const AnyDrive& drive : drives_)
    visitKind([&](const auto& it) { it.release(outboxes_[it.bus()]); }, drive);
}

/// A drive whose reply is of before a pause, or of its middle, is not behind for the way of the
/// pause.
double CanRobot::placeToTrack(int joint) const noexcept {
  const auto [now, before] = places_.at(joint);
  if (!std::isfinite(now)) return now;
  return std::clamp(drive(joint).position, std::min(before, now), std::max(before, now));
}

const DriveReport& CanRobot::drive(int joint) const noexcept { return reportOf(drives_[joint]); }

DrivesReport CanRobot::drives() const noexcept {
  DrivesReport all;
  all.are_configured = all.are_enabled = true;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const DriveReport& report = reportOf(drives_[i]);
    all.are_configured = all.are_configured && report.is_configured;
    all.are_enabled = all.are_enabled && report.state == DriveState::kOperationEnabled;
    all.is_any_holding = all.is_any_holding || (isReachable(report) && mayHold(report));
    all.are_disabled = all.are_disabled && !isPowered(report);
    all.is_any_moving_on = all.is_any_moving_on || report.is_moving_on;
    if (report.fault == Fault::kNone || all.fault != Fault::kNone) continue;
    all.fault = report.fault;
    all.joint = static_cast<int>(i);
  }
  return all;
}

bool CanRobot::isHolding(int joint) const noexcept {
  const DriveReport& report = drive(joint);
  return isReachable(report) && report.has_state && holds(report.state) && !report.is_cut_off;
}

bool CanRobot::hasPower(int joint) const noexcept { return isPowered(drive(joint)); }

int CanRobot::firstWithPower() const noexcept {
  for (int joint = 0; joint < static_cast<int>(drives_.size()); ++joint)
    if (hasPower(joint)) return joint;
  return -1;
}

bool CanRobot::hasPositions() const noexcept {
  return std::all_of(drives_.begin(), drives_.end(),
                     [](const AnyDrive& drive) { return reportOf(drive).has_position; });
}

long long CanRobot::malformedFrames() const noexcept {
  long long frames = 0;
  for (const AnyDrive& drive : drives_)
    frames += visitKind([](const auto& it) { return it.malformedFrames(); }, drive);
  return frames;
}

}  // namespace tactus
