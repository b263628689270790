#include "tactus/sim/arm_dynamics.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tactus {
namespace {

constexpr double kStickSpeed = 1e-5;  ///< rad/s or m/s; up to there friction sticks
constexpr int kMaxSolutions = 24;     ///< of one step; three do, but for one step in 20 000

bool exists(const JointVector& effect) noexcept { return effect.size() > 0; }

/// To the piece where x is; from one end to the other by way of the middle.
bool follow(double x, double half_width, int& piece) noexcept {
  const int there = x > half_width ? 1 : x < -half_width ? -1 : 0;
  const int next = piece * there < 0 ? 0 : there;
  const bool is_changed = next != piece;
  piece = next;
  return is_changed;
}

bool fits(const JointVector& effect, Eigen::Index joints) noexcept {
  return !exists(effect) || effect.size() == joints;
}

}  // namespace

ArmDynamics::ArmDynamics(const SerialChain& chain, const ArmDynamicsConfig& config,
                         const JointVector& q)
    : chain_(chain),
      config_(config),
      has_pieces_(exists(config.max_torque) || exists(config.coulomb_friction) ||
                  exists(config.viscous_friction) || exists(config.backlash)),
      q_(q),
      v_(JointVector::Zero(q.size())),
      q_motor_(q),
      v_motor_(JointVector::Zero(q.size())) {
  const auto n = static_cast<Eigen::Index>(chain.size());
  const bool is_complete = config.bodies.size() == static_cast<std::size_t>(n) && q.size() == n &&
                           config.rotor_inertia.size() == n && config.gear_stiffness.size() == n &&
                           config.gear_damping.size() == n && fits(config.max_torque, n) &&
                           fits(config.coulomb_friction, n) && fits(config.viscous_friction, n) &&
                           fits(config.backlash, n);
  if (!is_complete) throw std::invalid_argument("one body, rotor and gear a joint are needed");
  MassMatrix with_rotors = massMatrixAt(chain_, config_.bodies, q);
  with_rotors.diagonal() += config_.rotor_inertia;
  if (with_rotors.llt().info() != Eigen::Success || !with_rotors.allFinite())
    throw std::invalid_argument("the arm's mass matrix is not positive definite");
  for (Eigen::Index i = 0; exists(config.backlash) && i < n; ++i)
    if (config.backlash[i] > 0.0 && !(config.rotor_inertia[i] > 0.0))
      throw std::invalid_argument("a gear with backlash needs a rotor with inertia");
  const double w_b = 2.0 * std::numbers::pi * config_.servo_bandwidth_hz;
  const double w_i = 2.0 * std::numbers::pi * config_.servo_integral_hz;
  servo_damping_ = w_b * with_rotors.diagonal();
  servo_stiffness_ = w_i * servo_damping_;
}

void ArmDynamics::step(double step_s, const JointVector& q_desired,
                       const JointVector& velocity_setpoint, const JointVector& torque,
                       const ChainPose& pose) noexcept {
  const Setpoints to{step_s, q_desired, velocity_setpoint};
  MassMatrix M;
  computeMassMatrix(chain_, pose, config_.bodies, M);
  const JointVector push = M * v_ + step_s * torque;
  Speeds next{v_, v_motor_};
  for (Pieces& pieces : pieces_) pieces.limit = 0;
  for (int i = 0; i < kMaxSolutions; ++i) {
    solve(to, M, push, next);
    if (!has_pieces_ || !correct(to, next)) break;
  }
  v_ = next.links;
  v_motor_ = next.motors;
  q_ += step_s * v_;
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const bool is_rigid = std::isinf(config_.gear_stiffness[i]);
    q_motor_[i] = is_rigid ? q_[i] : q_motor_[i] + step_s * v_motor_[i];
  }
}

ArmDynamics::Drive ArmDynamics::servo(const Setpoints& to, Eigen::Index i) const noexcept {
  const double h = to.step_s;
  return {h * servo_damping_[i] * to.velocity[i] +
              h * servo_stiffness_[i] * (to.q_desired[i] - q_motor_[i]),
          h * servo_damping_[i] + h * h * servo_stiffness_[i]};
}

/// Servo and friction, with the pieces that hold.
ArmDynamics::Drive ArmDynamics::drive(const Setpoints& to, Eigen::Index i) const noexcept {
  const double h = to.step_s;
  const Pieces& pieces = pieces_[static_cast<std::size_t>(i)];
  Drive drive = servo(to, i);
  if (!has_pieces_) return drive;
  if (pieces.limit != 0) drive = {h * pieces.limit * config_.max_torque[i], 0.0};
  if (exists(config_.viscous_friction)) drive.damping += h * config_.viscous_friction[i];
  if (!exists(config_.coulomb_friction)) return drive;
  const double friction = h * config_.coulomb_friction[i];
  if (pieces.slip == 0)
    drive.damping += friction / kStickSpeed;
  else
    drive.push -= pieces.slip * friction;
  return drive;
}

/// With play its damper resists only while it is in touch, or touching would pull.
ArmDynamics::Gear ArmDynamics::gear(Eigen::Index i) const noexcept {
  const Gear gear{config_.gear_stiffness[i], config_.gear_damping[i], q_motor_[i] - q_[i]};
  if (!exists(config_.backlash)) return gear;
  const double half_play = 0.5 * config_.backlash[i];
  const int side = pieces_[static_cast<std::size_t>(i)].side;
  if (side == 0 && half_play > 0.0) return {0.0, 0.0, 0.0};
  const bool touches = std::abs(gear.stretch) >= half_play;
  return {gear.stiffness, touches ? gear.damping : 0.0, gear.stretch - side * half_play};
}

void ArmDynamics::solve(const Setpoints& to, MassMatrix A, JointVector b,
                        Speeds& next) const noexcept {
  const double h = to.step_s;
  JointVector motor_push(q_.size()), coupling(q_.size()), motor(q_.size());
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const auto [push, damping] = drive(to, i);
    const double J = config_.rotor_inertia[i];
    if (std::isinf(config_.gear_stiffness[i])) {
      A(i, i) += J + damping;
      b[i] += J * v_[i] + push;
      continue;
    }
    // The motor's equation is solved for its speed, which leaves those of the links.
    const auto [K, D, stretch] = gear(i);
    coupling[i] = h * D + h * h * K;
    const double spring = h * K * stretch;
    motor[i] = J + damping + coupling[i];
    motor_push[i] = J * v_motor_[i] + push - spring;
    A(i, i) += coupling[i] - coupling[i] * coupling[i] / motor[i];
    b[i] += spring + coupling[i] / motor[i] * motor_push[i];
  }
  next.links = A.llt().solve(b);
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const bool is_rigid = std::isinf(config_.gear_stiffness[i]);
    next.motors[i] =
        is_rigid ? next.links[i] : (motor_push[i] + coupling[i] * next.links[i]) / motor[i];
  }
}

/// False if all pieces fit the speeds. A torque that was limited stays so for the step.
bool ArmDynamics::correct(const Setpoints& to, const Speeds& next) noexcept {
  bool is_changed = false;
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    Pieces& pieces = pieces_[static_cast<std::size_t>(i)];
    if (exists(config_.max_torque) && pieces.limit == 0) {
      const Drive wanted = servo(to, i);
      const double torque = (wanted.push - wanted.damping * next.motors[i]) / to.step_s;
      is_changed |= follow(torque, config_.max_torque[i], pieces.limit);
    }
    if (exists(config_.coulomb_friction))
      is_changed |= follow(next.motors[i], kStickSpeed, pieces.slip);
    if (exists(config_.backlash) && !std::isinf(config_.gear_stiffness[i])) {
      const double stretch = q_motor_[i] - q_[i] + to.step_s * (next.motors[i] - next.links[i]);
      is_changed |= follow(stretch, 0.5 * config_.backlash[i], pieces.side);
    }
  }
  return is_changed;
}

}  // namespace tactus
