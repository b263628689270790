#include "tactus/sim/simulated_robot.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

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

double shortestStep_s(const ControllerConfig& robot, const PlantConfig& plant, double period_s) {
  if (plant.modules.size() < robot.tactile_modules.size())
    throw std::invalid_argument("each tactile module must have a simulated one");
  double step_s = period_s;
  for (std::size_t i = 0; i < robot.tactile_modules.size(); ++i)
    step_s = std::min(step_s, 1.0 / plant.modules[i].filter_rate_hz);
  return step_s;
}

/// Of a force at a point, both in the module's frame, about its origin.
Wrench4 wrenchAt(const Vector3& p, const Vector3& F) {
  const Vector3 M = p.cross(F);
  return {F.y(), F.z(), M.y(), M.z()};
}

}  // namespace

SimulatedRobot::SimulatedRobot(const ControllerConfig& robot, const PlantConfig& plant,
                               double period_s)
    : chain_(robot.chain),
      limits_(robot.limits),
      step_s_(shortestStep_s(robot, plant, period_s)),
      steps_a_cycle_(wholeRatio(period_s, step_s_)),
      drive_share_(lagShare(step_s_, plant.drive_lag_s)),
      q_commanded_(robot.q_start),
      q_(robot.q_start) {
  chain_.computePose(q_, pose_);
  for (std::size_t i = 0; i < robot.tactile_modules.size(); ++i) {
    const TactileModuleConfig& config = robot.tactile_modules[i];
    const SimulatedModuleConfig& module = plant.modules[i];
    modules_.push_back({config.link,
                        config.length_m,
                        module.cover_radius_m,
                        SimulatedModule(module),
                        {},
                        framePose(pose_, config.link)});
    modules_.back().steps_a_filter_step = wholeRatio(1.0 / module.filter_rate_hz, step_s_);
    for (const ObstacleConfig& obstacle : plant.obstacles)
      modules_.back().obstacles.emplace_back(obstacle, plant.robot_stiffness_N_per_m);
  }
}

void SimulatedRobot::read(RobotInput& input) noexcept {
  input.q_measured = q_;
  for (int i = 0; i < modules(); ++i) input.tactile[i] = modules_[i].electronics.sample();
}

void SimulatedRobot::write(const JointVector& velocity_setpoint) noexcept {
  for (int i = 0; i < steps_a_cycle_; ++i, ++step_) {
    moveArm(velocity_setpoint);
    for (Module& module : modules_) {
      const Wrench4 wrench = contactWrench(module);
      if (step_ % module.steps_a_filter_step == 0) module.electronics.update(wrench);
    }
  }
}

void SimulatedRobot::moveArm(const JointVector& velocity_setpoint) noexcept {
  q_commanded_ += step_s_ * velocity_setpoint;
  q_commanded_ = q_commanded_.cwiseMax(limits_.lower).cwiseMin(limits_.upper);
  q_ += drive_share_ * (q_commanded_ - q_);
  chain_.computePose(q_, pose_);
}

Wrench4 SimulatedRobot::contactWrench(Module& module) const noexcept {
  const Pose X_BaseModule = framePose(pose_, module.link);
  const ModuleStep step{X_BaseModule, std::exchange(module.X_BaseModule, X_BaseModule)};
  const CoverAxis axis{X_BaseModule.p_AB, X_BaseModule.R_AB.col(0), module.length_m,
                       module.cover_radius_m};
  Vector3 force_Base = Vector3::Zero();
  Wrench4 wrench = Wrench4::Zero();
  const double t_s = static_cast<double>(step_) * step_s_;
  for (Obstacle& obstacle : module.obstacles) {
    const ObstacleContact contact = obstacle.touch(axis, t_s);
    if (obstacle.hasFriction()) {
      const ObstacleFriction friction = obstacle.rub(step, axis, contact);
      force_Base += friction.force_Base;
      wrench +=
          wrenchAt(friction.p_ModuleSurface, X_BaseModule.R_AB.transpose() * friction.force_Base);
    }
    if (contact.force_N == 0.0) continue;
    const Vector3 F = X_BaseModule.R_AB.transpose() * contact.force_Base;
    force_Base += contact.force_Base;
    wrench += Wrench4(F.y(), F.z(), -contact.position_m * F.z(), contact.position_m * F.y());
  }
  module.true_force_N = force_Base.norm();
  return wrench;
}

}  // namespace tactus
