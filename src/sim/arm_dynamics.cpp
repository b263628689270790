#include "tactus/sim/arm_dynamics.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tactus {

ArmDynamics::ArmDynamics(const SerialChain& chain, const ArmDynamicsConfig& config,
                         const JointVector& q)
    : chain_(chain),
      config_(config),
      q_(q),
      v_(JointVector::Zero(q.size())),
      q_motor_(q),
      v_motor_(JointVector::Zero(q.size())) {
  const auto n = static_cast<Eigen::Index>(chain.size());
  const bool fits = config.bodies.size() == static_cast<std::size_t>(n) && q.size() == n &&
                    config.rotor_inertia.size() == n && config.gear_stiffness.size() == n &&
                    config.gear_damping.size() == n;
  if (!fits) throw std::invalid_argument("one body, rotor and gear a joint are needed");
  MassMatrix with_rotors = massMatrixAt(chain_, config_.bodies, q);
  with_rotors.diagonal() += config_.rotor_inertia;
  if (with_rotors.llt().info() != Eigen::Success || !with_rotors.allFinite())
    throw std::invalid_argument("the arm's mass matrix is not positive definite");
  const double w_b = 2.0 * std::numbers::pi * config_.servo_bandwidth_hz;
  const double w_i = 2.0 * std::numbers::pi * config_.servo_integral_hz;
  servo_damping_ = w_b * with_rotors.diagonal();
  servo_stiffness_ = w_i * servo_damping_;
}

void ArmDynamics::step(double step_s, const JointVector& q_desired,
                       const JointVector& velocity_setpoint, const JointVector& torque,
                       const ChainPose& pose) noexcept {
  const double h = step_s;
  MassMatrix A;
  computeMassMatrix(chain_, pose, config_.bodies, A);
  JointVector b = A * v_ + h * torque;
  JointVector motor_push(q_.size()), coupling(q_.size()), motor(q_.size());
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const double servo = h * servo_damping_[i] + h * h * servo_stiffness_[i];
    const double drive = h * servo_damping_[i] * velocity_setpoint[i] +
                         h * servo_stiffness_[i] * (q_desired[i] - q_motor_[i]);
    const double J = config_.rotor_inertia[i];
    if (std::isinf(config_.gear_stiffness[i])) {
      A(i, i) += J + servo;
      b[i] += J * v_[i] + drive;
      continue;
    }
    // The motor's equation is solved for its speed, which leaves those of the links.
    const double K = config_.gear_stiffness[i];
    coupling[i] = h * config_.gear_damping[i] + h * h * K;
    const double spring = h * K * (q_motor_[i] - q_[i]);
    motor[i] = J + servo + coupling[i];
    motor_push[i] = J * v_motor_[i] + drive - spring;
    A(i, i) += coupling[i] - coupling[i] * coupling[i] / motor[i];
    b[i] += spring + coupling[i] / motor[i] * motor_push[i];
  }
  v_ = A.llt().solve(b);
  q_ += h * v_;
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const bool is_rigid = std::isinf(config_.gear_stiffness[i]);
    v_motor_[i] = is_rigid ? v_[i] : (motor_push[i] + coupling[i] * v_[i]) / motor[i];
    q_motor_[i] = is_rigid ? q_[i] : q_motor_[i] + h * v_motor_[i];
  }
}

}  // namespace tactus
