#pragma once

#include <vector>

#include "tactus/bench/mujoco_model.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/simulated_module.h"

namespace tactus::physics {

inline constexpr double kMujocoStep_s = 0.000125;

/// The robot interface over an arm that MuJoCo moves, as a second opinion on SimulatedRobot with
/// PlantConfig::dynamics.
///
/// MuJoCo's own: kinematics, mass matrix, centrifugal forces, gears, servos, integration, where and
/// how covers and posts touch, and dry friction with its cone. An obstacle is a light post on
/// springs, which a hard contact pushes out of its place, where the built-in plant has a massless
/// line and a bristle.
/// Shared, hence not judged: the description of robot and scene, the spring's curve of force over
/// way (ContactSpring), the electronics of the tactile module, and the controller.
class MujocoRobot final : public Robot {
 public:
  /// step_s: of MuJoCo's integration; filter periods and period_s are multiples of it. Throws
  /// std::invalid_argument for what it cannot do: an arm without mass, obstacles that come or go,
  /// or are bars, contact beside modules.
  MujocoRobot(const ControllerConfig& robot, const PlantConfig& plant, double period_s,
              double step_s = kMujocoStep_s);

  void read(RobotInput& input) noexcept override;
  void write(const JointVector& velocity_setpoint) noexcept override;

  /// The tool, base frame, m.
  Vector3 toolPosition() const noexcept { return inBase(tip_).p_AB; }
  /// Norm of the summed contact force on a module's cover, N.
  double trueForce_N(int module = 0) const noexcept {
    return modules_.empty() ? 0.0 : modules_[module].force_Base.norm();
  }
  /// M(q) of the links and their rotors; with flexible gears for a motor and its gear each, in
  /// this order.
  Eigen::MatrixXd massMatrix() const;
  /// Nothing was set right by MuJoCo's own hand: a state that is not finite, lost contacts.
  bool isSound() const noexcept;

 private:
  struct Module {
    AttachedFrame link;
    int geom;
    SimulatedModule electronics;
    int steps_a_filter_step;
    Vector3 force_Base = Vector3::Zero();
    Wrench5 wrench = Wrench5::Zero();
  };
  struct Post {
    int geom, dof;
    ContactSpring spring;
    double shear_stiffness_N_per_m;
    Swing swing;
    Vector3 pushed;  ///< 1 for axes along which it may be pushed, 0 for others
    double damping_N_s_per_m;
    Vector3 normal_Base = Vector3::Zero();  ///< into the post; zero while nothing touches it
  };

  void addPosts(const ControllerConfig& robot, const PlantConfig& plant);
  void addModules(const ControllerConfig& robot, const PlantConfig& plant);
  void tuneServos(const ArmDynamicsConfig& arm);
  void step(const JointVector& velocity_setpoint) noexcept;
  Vector3 homeOf(const Post& post) const noexcept;
  void pushPostsBack() noexcept;
  void feelContacts() noexcept;
  Pose inBase(const AttachedFrame& frame) const noexcept;

  int size_;  ///< joints
  AttachedFrame tip_;
  JointLimits limits_;
  int steps_a_cycle_;
  MujocoModel model_;
  MujocoData data_;
  std::vector<int> motor_;  ///< places in qpos
  JointVector servo_damping_, servo_stiffness_;
  std::vector<Module> modules_;
  std::vector<Post> posts_;
  JointVector q_desired_;
  long step_ = 0;
};

}  // namespace tactus::physics
