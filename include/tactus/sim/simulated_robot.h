#pragma once

#include <optional>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"
#include "tactus/sim/arm_dynamics.h"
#include "tactus/sim/drive_setpoints.h"
#include "tactus/sim/link_contacts.h"
#include "tactus/sim/moving_cover.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/simulated_module.h"
#include "tactus/sim/velocity_loop.h"

namespace tactus {

/// The robot interface over a simulated arm among obstacles. write() moves the world on by one
/// period: drives integrate the setpoint and follow with their lag, or move an arm that has mass;
/// obstacles push on the covers, the tactile modules filter and sample.
class SimulatedRobot final : public Robot {
 public:
  /// Throws std::invalid_argument unless period and filter periods (1 / filter_rate_hz) are
  /// multiples of the shortest of them, and `plant` has a module for each that the controller
  /// reads.
  SimulatedRobot(const ControllerConfig& robot, const PlantConfig& plant, double period_s);

  void read(RobotInput& input) noexcept override;
  void write(const JointVector& velocity_setpoint) noexcept override;

  /// The tool of the simulated arm, base frame, m.
  Vector3 toolPosition() const noexcept { return framePosition(pose_, chain_.tip()); }
  int modules() const noexcept { return static_cast<int>(modules_.size()); }
  const SimulatedModule& module(int i) const noexcept { return modules_[i].electronics; }
  /// Norm of the summed contact force on a module's cover, before its filter, N; 0 without modules.
  double trueForce_N(int module = 0) const noexcept {
    return modules_.empty() ? 0.0 : modules_[module].true_force_N;
  }
  /// The strongest that one obstacle pushes on a module's cover, which the sum above may hide, N.
  double hardestContact_N(int module) const noexcept { return modules_[module].hardest_N; }
  /// What pushes where no module feels it; null unless the plant has capsules.
  const LinkContacts* linkContacts() const noexcept { return links_ ? &*links_ : nullptr; }
  /// Obstacles appear and vanish by a time that counts from now.
  void restartTime() noexcept {
    step_ = 0;
    if (links_) links_->forgetLargest();
  }

 private:
  struct Module {
    AttachedFrame link;
    double length_m, cover_radius_m;
    SimulatedModule electronics;
    std::vector<Obstacle> obstacles;  ///< as they meet this cover
    Pose X_BaseModule;                ///< in the last step
    std::optional<MovingCover> cover;
    int steps_a_filter_step = 1;
    double true_force_N = 0.0;
    double hardest_N = 0.0;                ///< of one obstacle alone
    Vector3 force_Base = Vector3::Zero();  ///< of all contacts, and what they are to the module
    Wrench5 wrench = Wrench5::Zero();
  };

  void moveArm(double duration_s, const JointVector& commanded) noexcept;
  void touch(double t_s, Module& module) noexcept;
  void touchLinks(double t_s) noexcept;
  void measure(Module& module) noexcept;
  void push(const Vector3& p_Module, const Vector3& force_Base, Module& module) noexcept;

  SerialChain chain_;
  JointLimits limits_;
  std::vector<Module> modules_;
  std::optional<LinkContacts> links_;
  double step_s_;  ///< of the plant: the shortest of cycle and filter periods
  int steps_a_cycle_;
  int parts_a_step_ = 1;  ///< where the arm has mass
  double drive_share_;
  bool reports_links_;
  std::optional<DriveSetpoints> setpoints_;
  std::optional<VelocityLoop> loop_;
  std::optional<ArmDynamics> dynamics_;
  std::vector<Vector3> slid_m_;  ///< of each obstacle's foot
  JointVector torque_;           ///< of all contacts; only where the arm has mass
  long step_ = 0;
  JointVector q_commanded_;
  JointVector q_;   ///< of the arm
  ChainPose pose_;  ///< at q_
};

}  // namespace tactus
