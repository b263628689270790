#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "tactus/bench/bench_robot.h"
#include "tactus/control/command_limiter.h"
#include "tactus/control/contact_point.h"
#include "tactus/control/contact_transition.h"
#include "tactus/control/control_law.h"
#include "tactus/control/joint_limit_avoidance.h"
#include "tactus/control/stiffness_estimator.h"
#include "tactus/math/trajectory.h"

namespace tactus {

/// Kinematics and linear algebra of one configuration as other code does them. W = I.
class PlainKinematics {
 public:
  virtual ~PlainKinematics() = default;
  virtual void move(const JointVector& q) = 0;
  virtual Pose tool() const = 0;                                        ///< base frame
  virtual Eigen::VectorXd inverse(const Eigen::VectorXd& w) const = 0;  ///< J# w
  virtual Eigen::VectorXd project(const Eigen::VectorXd& v) const = 0;  ///< N v
  /// J_p^T F^, (16), and the contact point in the base frame.
  virtual Eigen::VectorXd contactDirection(const ContactPointState& contact,
                                           Vector3& p_BaseContact) const = 0;
};

/// As users write it from the paper: Eigen's dynamic matrices, J# by JacobiSVD, N = I - J# J
/// formed.
std::unique_ptr<PlainKinematics> svdKinematics(const BenchRobot& robot);

/// By KDL's solvers: each J# w is a call of ChainIkSolverVel_wdls, and N v = v - J# (J v).
std::unique_ptr<PlainKinematics> wdlsKinematics(const BenchRobot& robot);

struct PlainControllerState {
  JointVector q_desired, velocity_before;
  ContactPointState contact_point;
  std::uint32_t sample_sequence = 0;
  ContactTransitionState transition;
  StiffnessEstimatorState estimator;
  ControlLawState law;
  Eigen::VectorXd contact_direction;  ///< J_p^T F^ of the last cycle
  double cut_m_per_s = 0.0;           ///< of its retreat, by limits
};

/// The control step of Controller around other kinematics and linear algebra. Laws, estimator and
/// limits are the same, and the commands agree to round-off away from singularities.
class PlainController {
 public:
  PlainController(const BenchRobot& robot, std::unique_ptr<PlainKinematics> kinematics);

  PlainControllerState initialState() const;

  /// Returns the command, m/s or rad/s.
  JointVector update(const RobotInput& input, double t_s, double period_s,
                     PlainControllerState& state);

 private:
  Eigen::VectorXd taskVelocity(double t_s) const;
  Eigen::VectorXd answer(const RobotInput& input, const Eigen::VectorXd& q_dot_eff, double period_s,
                         PlainControllerState& state) const;

  ControllerConfig config_;
  std::unique_ptr<PlainKinematics> kinematics_;
  ScaledVector ones_;
  Trajectory trajectory_;
  CommandLimiter limiter_;
  JointLimitAvoidance joint_limits_;
  JointLimitZones zones_;
  std::optional<ControlLaw> law_;
};

}  // namespace tactus
