#pragma once

#include <span>

#include "tactus/canopen/can_robot.h"
#include "tactus/supervisor/mode_report.h"

namespace tactus {

/// Where an arm is, before anything moves it: sets its drives up, which takes their torque, hears
/// where they are once all of them are off, and lets them go. In frames, as CanRobot. A cycle:
/// receive() for each bus, update(), then the outboxes, also of the last one.
class JointReader {
 public:
  JointReader(const HardwareConfig& hardware, double period_s);

  void receive(int bus, std::span<const CanFrame> frames) noexcept { robot_.receive(bus, frames); }
  void update(std::span<const Fault> bus_faults) noexcept;  ///< one a bus
  const FrameBatch& outbox(int bus) const noexcept { return robot_.outbox(bus); }
  void noteHeldBack(int bus) noexcept { robot_.noteHeldBack(bus); }
  const CanFrame& probe() const noexcept { return robot_.probe(); }

  void leave() noexcept { robot_.release(); }  ///< in place of update(): lets the drives go

  /// All positions are known, or report() says why not, by the drives' own limits of time and
  /// stop_deadline_s.
  bool isDone() const noexcept { return is_done_; }
  const FaultReport& report() const noexcept { return report_; }
  const JointVector& q() const noexcept { return input_.q_measured; }  ///< m or rad

 private:
  void judge(std::span<const Fault> bus_faults, const DrivesReport& drives) noexcept;

  CanRobot robot_;
  JointVector rest_;
  RobotInput input_;
  FaultReport report_;
  int stopping_cycles_ = 0;  ///< since all drives are set up
  int stop_deadline_cycles_;
  bool is_first_ = true, is_done_ = false;
};

}  // namespace tactus
