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
Wrench5 wrenchAt(const Vector3& p, const Vector3& F) {
  const Vector3 M = p.cross(F);
  return Wrench5{{F.y(), F.z(), M.y(), M.z(), M.x()}};
}

}  // namespace

SimulatedRobot::SimulatedRobot(const ControllerConfig& robot, const PlantConfig& plant,
                               double period_s)
    : chain_(plant.chain ? *plant.chain : robot.chain),
      limits_(robot.limits),
      step_s_(shortestStep_s(robot, plant, period_s)),
      steps_a_cycle_(wholeRatio(period_s, step_s_)),
      drive_share_(lagShare(step_s_, plant.drive_lag_s)),
      reports_links_(plant.drives.reports_links),
      slid_m_(plant.obstacles.size(), Vector3::Zero()),
      q_commanded_(robot.q_start),
      q_(robot.q_start) {
  chain_.computePose(q_, pose_);
  if (plant.dynamics) {
    dynamics_.emplace(chain_, *plant.dynamics, q_);
    torque_ = JointVector::Zero(q_.size());
    parts_a_step_ =
        std::max(1, static_cast<int>(std::ceil(step_s_ / plant.dynamics->step_s - 1e-6)));
  }
  const DriveEffectsConfig& drives = plant.drives;
  if (drives.dead_time_s > 0.0 || drives.max_acceleration.size() > 0)
    setpoints_.emplace(drives, chain_.size(), step_s_ / parts_a_step_);
  if (drives.loop) loop_.emplace(*drives.loop, q_, step_s_);
  if (!plant.capsules.empty()) links_.emplace(plant, pose_);
  for (std::size_t i = 0; i < robot.tactile_modules.size(); ++i) {
    const TactileModuleConfig& config = robot.tactile_modules[i];
    const SimulatedModuleConfig& module = plant.modules[i];
    const Pose X_BaseModule = framePose(pose_, config.link);
    std::optional<MovingCover> cover;
    std::optional<Wrench5> at_rest;
    if (module.cover) {
      cover.emplace(*module.cover, plant.gravity_Base, X_BaseModule);
      at_rest = cover->atRest();
    }
    modules_.push_back({config.link,
                        config.length_m,
                        module.cover_radius_m,
                        SimulatedModule(module, at_rest),
                        {},
                        X_BaseModule,
                        cover});
    modules_.back().steps_a_filter_step = wholeRatio(1.0 / module.filter_rate_hz, step_s_);
    for (const ObstacleConfig& obstacle : plant.obstacles)
      modules_.back().obstacles.emplace_back(obstacle, plant.robot_stiffness_N_per_m);
  }
}

void SimulatedRobot::read(RobotInput& input) noexcept {
  input.q_measured = dynamics_ && !reports_links_ ? dynamics_->qMotor() : q_;
  for (int i = 0; i < modules(); ++i) input.tactile[i] = modules_[i].electronics.sample();
}

void SimulatedRobot::write(const JointVector& velocity_setpoint) noexcept {
  for (int i = 0; i < steps_a_cycle_; ++i, ++step_) {
    for (int part = 0; part < parts_a_step_; ++part) {
      moveArm(step_s_ / parts_a_step_, velocity_setpoint);
      const double steps = static_cast<double>(step_) + static_cast<double>(part) / parts_a_step_;
      for (Module& module : modules_) touch(steps * step_s_, module);
      if (links_) touchLinks(steps * step_s_);
    }
    for (Module& module : modules_)
      if (step_ % module.steps_a_filter_step == 0) measure(module);
  }
}

void SimulatedRobot::measure(Module& module) noexcept {
  if (!module.cover) return module.electronics.update(module.wrench);
  const double filter_step_s = module.steps_a_filter_step * step_s_;
  module.electronics.update(module.wrench +
                            module.cover->update(module.X_BaseModule, filter_step_s));
}

void SimulatedRobot::moveArm(double duration_s, const JointVector& commanded) noexcept {
  const JointVector& velocity_setpoint = setpoints_ ? setpoints_->update(commanded) : commanded;
  q_commanded_ += duration_s * velocity_setpoint;
  q_commanded_ = q_commanded_.cwiseMax(limits_.lower).cwiseMin(limits_.upper);
  if (dynamics_) {
    dynamics_->step(duration_s, q_commanded_, velocity_setpoint, torque_, pose_);
    q_ = dynamics_->q();
    torque_.setZero();
  } else if (loop_) {
    loop_->update(q_commanded_, q_);
  } else {
    q_ += drive_share_ * (q_commanded_ - q_);
  }
  chain_.computePose(q_, pose_);
}

void SimulatedRobot::touch(double t_s, Module& module) noexcept {
  const Pose X_BaseModule = framePose(pose_, module.link);
  const ModuleStep step{X_BaseModule, std::exchange(module.X_BaseModule, X_BaseModule)};
  const CoverAxis axis{X_BaseModule.p_AB, X_BaseModule.R_AB.col(0), module.length_m,
                       module.cover_radius_m};
  module.force_Base.setZero();
  module.wrench.setZero();
  module.hardest_N = 0.0;
  for (std::size_t k = 0; k < module.obstacles.size(); ++k) {
    Obstacle& obstacle = module.obstacles[k];
    const ObstacleContact contact = obstacle.touch(axis, t_s, &slid_m_[k]);
    Vector3 force_Base = contact.force_Base;
    if (obstacle.hasFriction()) {
      const ObstacleFriction friction = obstacle.rub(step, axis, contact);
      push(friction.p_ModuleSurface, friction.force_Base, module);
      force_Base += friction.force_Base;
    }
    module.hardest_N = std::max(module.hardest_N, force_Base.norm());
    if (contact.force_N != 0.0)
      push(Vector3(contact.position_m, 0.0, 0.0), contact.force_Base, module);
  }
  module.true_force_N = module.force_Base.norm();
}

void SimulatedRobot::touchLinks(double t_s) noexcept {
  ScaledVector torque = ScaledVector::Zero();
  links_->touch(chain_, pose_, t_s, torque, slid_m_);
  if (dynamics_) torque_ += torque.head(chain_.size());
}

/// What a force at a point of a module is to its electronics, and to an arm with mass.
void SimulatedRobot::push(const Vector3& p_Module, const Vector3& force_Base,
                          Module& module) noexcept {
  const Pose& X_BaseModule = module.X_BaseModule;
  module.force_Base += force_Base;
  module.wrench += wrenchAt(p_Module, X_BaseModule.R_AB.transpose() * force_Base);
  if (!dynamics_) return;
  const Vector3 p_Base = X_BaseModule.p_AB + X_BaseModule.R_AB * p_Module;
  ScaledVector torque;
  applyPointJacobianTranspose(chain_, pose_, module.link.joint, p_Base, force_Base, torque);
  torque_ += torque.head(chain_.size());
}

}  // namespace tactus
