#pragma once

#include "tactus/scene/scene.h"
#include "tactus/supervisor/cycle_record.h"
#include "tactus/supervisor/mode_report.h"

namespace tactus {

/// The controller's cycles in virtual time, from the first one on, as the daemon has them with
/// drives that are always ready: it runs until a fault, then leaves the contact where that fault
/// asks for it, and ramps to rest.
class VirtualCycle {
 public:
  /// For an arm that stands at q, near the scene's start, m or rad.
  VirtualCycle(const Scene& scene, const JointVector& q);
  explicit VirtualCycle(const Scene& scene) : VirtualCycle(scene, scene.controller.q_start) {}

  /// A fault that only the caller can see, of a tactile module, in the cycle to come.
  void note(Fault fault, int module) noexcept;
  void update(const RobotInput& input) noexcept;

  const ControllerOutput& output() const noexcept { return output_; }
  const ControllerConfig& config() const noexcept { return controller_.config(); }
  /// Of the cycle to come, or of note().
  double time_s() const noexcept { return static_cast<double>(cycle_) * period_s_; }
  Mode mode() const noexcept { return mode_; }
  /// The first fault; a later one is not asked for.
  const FaultReport& end() const noexcept { return end_; }
  bool isAtRest() const noexcept;

  /// With the last cycle; but for times of phases and the tool's rotation, as fillRecord().
  void fill(const RobotInput& input, const Vector3& tool_error_m,
            CycleRecord& record) const noexcept;

 private:
  Controller controller_;
  double period_s_;
  ControllerState state_;
  ControllerOutput output_;
  FaultReport end_;
  Mode mode_ = Mode::kRunning;
  long long cycle_ = 0, task_cycle_ = 0;  ///< to come
  double t_s_ = 0.0, task_time_s_ = 0.0;  ///< of the last one
};

}  // namespace tactus
