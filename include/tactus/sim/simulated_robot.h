#pragma once

#include <optional>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/simulated_module.h"

namespace tactus {

/// The robot interface over a simulated arm among obstacles. write() moves the world on by one
/// period: drives integrate the setpoint and follow with their lag, obstacles push on the cover,
/// the tactile module filters and samples.
class SimulatedRobot final : public Robot {
 public:
  /// Throws std::invalid_argument unless the period is a multiple or a whole part of the module's
  /// filter period (1 / filter_rate_hz).
  SimulatedRobot(const ControllerConfig& robot, const PlantConfig& plant, double period_s);

  void read(RobotInput& input) noexcept override;
  void write(const JointVector& velocity_setpoint) noexcept override;

  /// The tool of the simulated arm, base frame, m.
  Vector3 toolPosition() const noexcept { return framePosition(pose_, chain_.tip()); }
  /// Norm of the summed contact force before the module's filter, N.
  double trueForce_N() const noexcept { return true_force_N_; }
  /// Nullptr on a robot without tactile module.
  const SimulatedModule* module() const noexcept { return module_ ? &*module_ : nullptr; }
  /// Obstacles appear and vanish by a time that counts from now.
  void restartTime() noexcept { step_ = 0; }

 private:
  void moveArm(const JointVector& velocity_setpoint) noexcept;
  Wrench4 contactWrench() noexcept;

  SerialChain chain_;
  JointLimits limits_;
  std::optional<TactileModuleConfig> module_config_;
  std::optional<SimulatedModule> module_;
  std::vector<Obstacle> obstacles_;
  double cover_radius_m_;
  double step_s_;  ///< of the plant: the shorter of cycle and filter period
  int steps_a_cycle_;
  int steps_a_filter_step_;
  double drive_share_;
  long step_ = 0;
  JointVector q_commanded_;
  JointVector q_;   ///< of the arm
  ChainPose pose_;  ///< at q_
  double true_force_N_ = 0.0;
};

}  // namespace tactus
