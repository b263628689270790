#include "tactus/sim/simulated_robot.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// longer / shorter if that is a whole number.
int wholeRatio(double longer, double shorter) {
  const double ratio = longer / shorter;
  if (!(std::abs(ratio - std::round(ratio)) <= 1e-6) || ratio < 0.5)
    throw std::invalid_argument(
        "the cycle period must be a multiple or a whole part of the tactile module's filter "
        "period");
  return static_cast<int>(std::lround(ratio));
}

}  // namespace

SimulatedRobot::SimulatedRobot(const ControllerConfig& robot, const PlantConfig& plant,
                               double period_s)
    : chain_(robot.chain),
      limits_(robot.limits),
      module_config_(robot.tactile_module),
      cover_radius_m_(plant.cover_radius_m),
      q_commanded_(robot.q_start),
      q_(robot.q_start) {
  const double filter_period_s = module_config_ ? 1.0 / plant.module.filter_rate_hz : period_s;
  step_s_ = std::min(period_s, filter_period_s);
  steps_a_cycle_ = wholeRatio(period_s, step_s_);
  steps_a_filter_step_ = wholeRatio(filter_period_s, step_s_);
  drive_share_ = lagShare(step_s_, plant.drive_lag_s);
  if (module_config_) {
    module_.emplace(plant.module);
    for (const ObstacleConfig& obstacle : plant.obstacles)
      obstacles_.emplace_back(obstacle, plant.robot_stiffness_N_per_m);
  }
  chain_.computePose(q_, pose_);
}

void SimulatedRobot::read(RobotInput& input) noexcept {
  input.q_measured = q_;
  if (module_) input.tactile = module_->sample();
}

void SimulatedRobot::write(const JointVector& velocity_setpoint) noexcept {
  for (int i = 0; i < steps_a_cycle_; ++i, ++step_) {
    moveArm(velocity_setpoint);
    if (!module_) continue;
    const Wrench4 wrench = contactWrench();
    if (step_ % steps_a_filter_step_ == 0) module_->update(wrench);
  }
}

void SimulatedRobot::moveArm(const JointVector& velocity_setpoint) noexcept {
  q_commanded_ += step_s_ * velocity_setpoint;
  q_commanded_ = q_commanded_.cwiseMax(limits_.lower).cwiseMin(limits_.upper);
  q_ += drive_share_ * (q_commanded_ - q_);
  chain_.computePose(q_, pose_);
}

Wrench4 SimulatedRobot::contactWrench() noexcept {
  const Pose X_BaseModule = framePose(pose_, module_config_->link);
  const CoverAxis axis{X_BaseModule.p_AB, X_BaseModule.R_AB.col(0), module_config_->length_m,
                       cover_radius_m_};
  Vector3 force_Base = Vector3::Zero();
  Wrench4 wrench = Wrench4::Zero();
  const double t_s = static_cast<double>(step_) * step_s_;
  for (Obstacle& obstacle : obstacles_) {
    const ObstacleContact contact = obstacle.touch(axis, t_s);
    if (contact.force_N == 0.0) continue;
    const Vector3 F = X_BaseModule.R_AB.transpose() * contact.force_Base;
    force_Base += contact.force_Base;
    wrench += Wrench4(F.y(), F.z(), -contact.position_m * F.z(), contact.position_m * F.y());
  }
  true_force_N_ = force_Base.norm();
  return wrench;
}

}  // namespace tactus
