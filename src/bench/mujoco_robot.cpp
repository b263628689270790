#include "tactus/bench/mujoco_robot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace tactus::physics {
namespace {

using RowMatrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr double kPostDamping = 0.5;    ///< of the post on its spring, share of the critical
constexpr double kPostPhase_rad = 0.5;  ///< of the post on its spring, a step

double shearStiffness(const ObstacleConfig& obstacle, double robot_stiffness_N_per_m) {
  return inSeries(obstacle.shear_stiffness_N_per_m.value_or(obstacle.stiffness_N_per_m),
                  robot_stiffness_N_per_m);
}

double stiffestSlope(const ObstacleConfig& obstacle, double robot_stiffness_N_per_m) {
  return std::max(inSeries(obstacle.stiffness_N_per_m, robot_stiffness_N_per_m),
                  shearStiffness(obstacle, robot_stiffness_N_per_m));
}

/// As light as the step stands.
MujocoPost postOf(const ObstacleConfig& obstacle, double robot_stiffness_N_per_m, double step_s) {
  if (obstacle.appears_s > 0.0 || obstacle.vanishes_s != kNoLimit)
    throw std::invalid_argument("obstacles have to be there all the time");
  if (obstacle.slide_force_N) throw std::invalid_argument("obstacles have to stand");
  const double mass_kg =
      stiffestSlope(obstacle, robot_stiffness_N_per_m) * std::pow(step_s / kPostPhase_rad, 2);
  return mujocoPost(obstacle, mass_kg);
}

MujocoWorld worldOf(const ControllerConfig& robot, const PlantConfig& plant, double step_s) {
  MujocoWorld world{.covers = {}, .posts = {}, .step_s = step_s};
  for (std::size_t i = 0; i < robot.tactile_modules.size(); ++i) {
    const TactileModuleConfig& module = robot.tactile_modules[i];
    world.covers.push_back({module.link, module.length_m, plant.modules[i].cover_radius_m});
  }
  for (const ObstacleConfig& obstacle : plant.obstacles)
    world.posts.push_back(postOf(obstacle, plant.robot_stiffness_N_per_m, step_s));
  return world;
}

MujocoModel modelOf(const ControllerConfig& robot, const PlantConfig& plant, double step_s) {
  if (!plant.dynamics) throw std::invalid_argument("the arm needs masses");
  if (!plant.capsules.empty() || plant.chain)
    throw std::invalid_argument("the arm has to be the controller's, with modules alone");
  return loadMujoco(mujocoText(robot.chain, *plant.dynamics, worldOf(robot, plant, step_s)));
}

int stepsIn(double duration_s, double step_s) {
  const double steps = duration_s / step_s;
  if (!(std::abs(steps - std::round(steps)) < 1e-6) || steps < 0.5)
    throw std::invalid_argument("periods have to be multiples of the step");
  return static_cast<int>(std::lround(steps));
}

}  // namespace

MujocoRobot::MujocoRobot(const ControllerConfig& robot, const PlantConfig& plant, double period_s,
                         double step_s)
    : size_(robot.chain.size()),
      tip_(robot.chain.tip()),
      limits_(robot.limits),
      steps_a_cycle_(stepsIn(period_s, step_s)),
      model_(modelOf(robot, plant, step_s)),
      data_(mj_makeData(model_.get())),
      q_desired_(robot.q_start) {
  for (int i = 0; i < size_; ++i) {
    const int motor = mj_name2id(model_.get(), mjOBJ_JOINT, ("motor" + std::to_string(i)).c_str());
    motor_.push_back(model_->jnt_qposadr[motor]);
    data_->qpos[motor_.back()] = robot.q_start[i];
  }
  addModules(robot, plant);
  addPosts(robot, plant);
  mj_forward(model_.get(), data_.get());
  tuneServos(*plant.dynamics);
}

/// Geoms are numbered body by body, base first; those of one link in the order of the modules.
void MujocoRobot::addModules(const ControllerConfig& robot, const PlantConfig& plant) {
  std::vector<int> used(model_->nbody, 0);
  for (std::size_t i = 0; i < robot.tactile_modules.size(); ++i) {
    const SimulatedModuleConfig& config = plant.modules[i];
    const int body = robot.tactile_modules[i].link.joint + 1;
    modules_.push_back({robot.tactile_modules[i].link, model_->body_geomadr[body] + used[body]++,
                        SimulatedModule(config),
                        stepsIn(1.0 / config.filter_rate_hz, model_->opt.timestep)});
  }
}

void MujocoRobot::addPosts(const ControllerConfig& robot, const PlantConfig& plant) {
  if (modules_.empty()) return;
  int body = size_ + 1;  // behind the base and the links
  const int link = robot.tactile_modules.front().link.joint + 1;
  for (const ObstacleConfig& obstacle : plant.obstacles) {
    // The contact gives way by itself, the post's spring by the rest.
    const double others_N_per_m =
        inSeries(plant.robot_stiffness_N_per_m, -contactStiffness(*model_, body, link));
    const double stiffest_N_per_m = stiffestSlope(obstacle, plant.robot_stiffness_N_per_m);
    posts_.push_back({model_->body_geomadr[body], model_->body_dofadr[body],
                      ContactSpring(obstacle, others_N_per_m),
                      shearStiffness(obstacle, plant.robot_stiffness_N_per_m), obstacle.swing,
                      obstacle.sphere || obstacle.plane ? Vector3::Ones() : Vector3(1.0, 1.0, 0.0),
                      2.0 * kPostDamping * std::sqrt(stiffest_N_per_m * model_->body_mass[body])});
    ++body;
  }
}

/// By the inertia that each motor has at the start.
void MujocoRobot::tuneServos(const ArmDynamicsConfig& arm) {
  const Eigen::MatrixXd M = massMatrix();
  const double w_b = 2.0 * std::numbers::pi * arm.servo_bandwidth_hz;
  const double w_i = 2.0 * std::numbers::pi * arm.servo_integral_hz;
  servo_damping_.resize(size_);
  for (int i = 0; i < size_; ++i) servo_damping_[i] = w_b * M(motor_[i], motor_[i]);
  servo_stiffness_ = w_i * servo_damping_;
  for (int i = 0; i < size_; ++i) {
    model_->actuator_biasprm[mjNBIAS * i + 1] = -servo_stiffness_[i];
    model_->actuator_biasprm[mjNBIAS * i + 2] = -servo_damping_[i];
  }
}

Eigen::MatrixXd MujocoRobot::massMatrix() const {
  Eigen::MatrixXd M(model_->nv, model_->nv);  // symmetric, so that the order does not matter
  mj_fullM(model_.get(), M.data(), data_->qM);
  const int arm = model_->nv - 3 * static_cast<int>(posts_.size());
  return M.topLeftCorner(arm, arm);
}

void MujocoRobot::read(RobotInput& input) noexcept {
  input.q_measured.resize(size_);
  for (int i = 0; i < size_; ++i) input.q_measured[i] = data_->qpos[motor_[i]];
  for (std::size_t i = 0; i < modules_.size(); ++i)
    input.tactile[i] = modules_[i].electronics.sample();
}

void MujocoRobot::write(const JointVector& velocity_setpoint) noexcept {
  for (int i = 0; i < steps_a_cycle_; ++i) {
    step(velocity_setpoint);
    feelContacts();
    ++step_;
    for (Module& module : modules_)
      if (step_ % module.steps_a_filter_step == 0) module.electronics.update(module.wrench);
  }
}

void MujocoRobot::step(const JointVector& velocity_setpoint) noexcept {
  q_desired_ += model_->opt.timestep * velocity_setpoint;
  q_desired_ = q_desired_.cwiseMax(limits_.lower).cwiseMin(limits_.upper);
  for (int i = 0; i < size_; ++i)
    data_->ctrl[i] = servo_damping_[i] * velocity_setpoint[i] + servo_stiffness_[i] * q_desired_[i];
  pushPostsBack();
  mj_step(model_.get(), data_.get());
}

/// Where a post's springs hold it by now, from its place.
Vector3 MujocoRobot::homeOf(const Post& post) const noexcept {
  const double turns = post.swing.frequency_hz * static_cast<double>(step_) * model_->opt.timestep;
  return std::sin(2.0 * std::numbers::pi * turns) * Vector3(post.swing.x_m, post.swing.y_m, 0.0);
}

/// All joints have one coordinate, so that they are numbered in qpos as in qvel. Along the normal
/// by the obstacle's curve, across it by its shear stiffness.
void MujocoRobot::pushPostsBack() noexcept {
  for (const Post& post : posts_) {
    const Vector3 way = Eigen::Map<const Vector3>(data_->qpos + post.dof) - homeOf(post);
    Vector3 normal = post.normal_Base;
    if (normal.isZero()) normal = way.cwiseProduct(post.pushed).normalized();
    const double in_m = way.dot(normal);
    const double force_N = std::copysign(post.spring.force_N(std::abs(in_m)), in_m);
    Eigen::Map<Vector3>(data_->qfrc_applied + post.dof) =
        -force_N * normal - post.shear_stiffness_N_per_m * (way - in_m * normal) -
        post.damping_N_s_per_m * Eigen::Map<const Vector3>(data_->qvel + post.dof);
  }
}

/// Where MuJoCo's contacts push, for posts and modules.
void MujocoRobot::feelContacts() noexcept {
  for (Post& post : posts_) post.normal_Base.setZero();
  for (Module& module : modules_) {
    module.force_Base.setZero();
    module.wrench.setZero();
  }
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    double force[6];  // on geom2, in the contact's frame, whose rows are its axes
    mj_contactForce(model_.get(), data_.get(), i, force);
    const RowMatrix3 R = Eigen::Map<const RowMatrix3>(contact.frame);
    const Vector3 on_second = R.transpose() * Eigen::Map<const Vector3>(force);
    for (Post& post : posts_) {
      if (contact.geom1 != post.geom && contact.geom2 != post.geom) continue;
      const double sign = contact.geom2 == post.geom ? 1.0 : -1.0;
      post.normal_Base = sign * R.row(0).transpose().cwiseProduct(post.pushed).normalized();
    }
    for (Module& module : modules_) {
      if (contact.geom1 != module.geom && contact.geom2 != module.geom) continue;
      const Vector3 F_Base = contact.geom2 == module.geom ? on_second : Vector3(-on_second);
      const Pose X = inBase(module.link);
      const Vector3 F = X.R_AB.transpose() * F_Base;
      const Vector3 p = X.R_AB.transpose() * (Eigen::Map<const Vector3>(contact.pos) - X.p_AB);
      const Vector3 M = p.cross(F);
      module.force_Base += F_Base;
      module.wrench += Wrench5{{F.y(), F.z(), M.y(), M.z(), M.x()}};
    }
  }
}

Pose MujocoRobot::inBase(const AttachedFrame& frame) const noexcept {
  const int body = frame.joint + 1;
  const RowMatrix3 R = Eigen::Map<const RowMatrix3>(data_->xmat + 9 * body);
  const Vector3 p = Eigen::Map<const Vector3>(data_->xpos + 3 * body);
  return {R * frame.X_JointFrame.R_AB, p + R * frame.X_JointFrame.p_AB};
}

bool MujocoRobot::isSound() const noexcept {
  return std::all_of(std::begin(data_->warning), std::end(data_->warning),
                     [](const mjWarningStat& warning) { return warning.number == 0; });
}

}  // namespace tactus::physics
