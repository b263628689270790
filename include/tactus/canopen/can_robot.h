#pragma once

#include <array>
#include <span>
#include <vector>

#include "tactus/canopen/any_drive.h"
#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/canopen/joint_tracking.h"
#include "tactus/canopen/tactile_receiver.h"
#include "tactus/control/robot.h"

namespace tactus {

/// What is known of all drives together.
struct DrivesReport {
  bool are_configured = false;
  bool are_enabled = false;
  bool are_disabled = true;     ///< none that can be reached has power
  bool is_any_holding = false;  ///< one may yet hold its joint: power alone has no torque
  bool is_any_moving_on = false;
  Fault fault = Fault::kNone;
  int joint = -1;  ///< of that fault
};

/// Cycles between probes of a bus that is dead: 100, but longer than drives wait for a heartbeat.
/// A probe is one, and drives that hear it, but are not heard, have to stop by themselves.
int probeCycles(const CanopenConfig& canopen, double period_s) noexcept;

/// The robot interface over CAN: one drive a joint and the tactile modules, in frames. Knows no
/// socket and no clock. A cycle: receive() for each bus, expect(), read(), command(), write(), then
/// the outboxes.
class CanRobot final : public Robot {
 public:
  CanRobot(const HardwareConfig& hardware, double period_s);

  void receive(int bus, std::span<const CanFrame> frames) noexcept;
  /// Where the arm is commanded to be now, m or rad, for what read() judges.
  void expect(const JointVector& q) noexcept { places_.expect(q); }
  /// For cycles that were missed: drives' deadlines go on in them, and the heartbeat's period.
  void coast(int missed_cycles) noexcept;
  void read(RobotInput& input) noexcept override;  ///< a drive without feedback so far reads as 0

  /// What the drives shall do from the next write() on. is_restart: with kConfigure, begin anew.
  /// q: where the arm is commanded to be now, m or rad.
  void command(DriveGoal goal, bool is_restart, const JointVector& q) noexcept;
  void write(const JointVector& velocity_setpoint) noexcept override;

  /// In place of write(), when all is over; see Drive::release().
  void release() noexcept;

  /// What write() wants on the bus, in this order: the master's heartbeat, which behind SYNC
  /// would wait for all feedback; setpoints; SYNC. Heartbeat and SYNC where drives of CANopen are;
  /// nothing on a bus with a drive that only silence stops.
  const FrameBatch& outbox(int bus) const noexcept { return outboxes_[bus]; }

  /// Nothing of this bus's outbox was sent, so a heartbeat in it is due again: else one that is due
  /// in each other cycle of a bus that sends in each other one would never be.
  void noteHeldBack(int bus) noexcept { is_heartbeat_owed_[bus] = has_heartbeat_[bus]; }

  /// A frame that tells a dead bus's return and moves nothing; on such a bus only, each
  /// probeCycles().
  const CanFrame& probe() const noexcept { return heartbeat_; }

  DrivesReport drives() const noexcept;
  const DriveReport& drive(int joint) const noexcept;
  /// By what this joint's own drive says: known, in reach, and holding it or slowing it down.
  bool isHolding(int joint) const noexcept;
  /// What keeps this joint from being off: it can be reached, and is not seen without power.
  bool hasPower(int joint) const noexcept;
  int firstWithPower() const noexcept;  ///< a joint; -1: none
  bool hasPositions() const noexcept;
  /// Of all drives: frames of wrong size.
  long long malformedFrames() const noexcept;
  std::span<const TactileReceiver> tactileModules() const noexcept { return tactile_modules_; }
  std::span<TactileReceiver> tactileModules() noexcept { return tactile_modules_; }

 private:
  double placeToTrack(int joint) const noexcept;

  std::vector<AnyDrive> drives_;
  std::vector<TactileReceiver> tactile_modules_;
  std::vector<FrameBatch> outboxes_;                 ///< one a bus
  std::vector<bool> has_canopen_;                    ///< one a bus: drives of CANopen are there
  std::array<bool, kMaxBuses> has_heartbeat_{};      ///< is in the outbox
  std::array<bool, kMaxBuses> is_heartbeat_owed_{};  ///< was in the last one, in vain
  CanFrame heartbeat_;
  int cycles_a_heartbeat_;
  int cycles_to_heartbeat_ = 0;
  DriveGoal goal_ = DriveGoal::kSilent;
  bool is_restart_ = false;
  CommandedPlaces places_;
};

}  // namespace tactus
