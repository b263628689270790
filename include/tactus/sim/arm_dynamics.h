#pragma once

#include <vector>

#include "tactus/math/mass_matrix.h"

namespace tactus {

/// What moves an arm of rigid bodies: a motor a joint with a velocity servo, behind a gear that may
/// be flexible. Per joint in kg m^2, Nm/rad, Nm s/rad, or kg, N/m, N s/m of a prismatic one.
struct ArmDynamicsConfig {
  std::vector<BodyInertia> bodies;  ///< one a joint
  JointVector rotor_inertia;        ///< at the joint, >= 0
  JointVector gear_stiffness;       ///< infinite: rigid
  JointVector gear_damping;         ///< of the gear's spring, >= 0
  double servo_bandwidth_hz = 40.0;
  double servo_integral_hz = 8.0;  ///< zero of its integral part; 0: none
  double step_s = 0.000125;        ///< longest of the integration
};

/// Rigid bodies behind servos and gears, without gravity, which the drives carry, and without
/// centrifugal forces, which are small at the speeds of contact. Per joint:
///   M(q) q_ddot = K (theta - q) + D (theta_dot - q_dot) + tau
///   J theta_ddot = J_s w_b ((v - theta_dot) + w_i (q_d - theta)) - K (theta - q) - D (...)
/// with J_s the joint's own inertia at the start, v the velocity setpoint, q_d the way that it was
/// to go. A rigid gear adds J to M. Integrated by implicit Euler in springs, dampers and servos,
/// which stands any stiffness; the torques tau of contacts count as they are at the step's start.
class ArmDynamics {
 public:
  /// Throws std::invalid_argument unless there is one entry a joint, M positive definite.
  ArmDynamics(const SerialChain& chain, const ArmDynamicsConfig& config, const JointVector& q);

  /// One step of at most step_s. q_desired: at its end; torque: of contacts, on the joints.
  void step(double step_s, const JointVector& q_desired, const JointVector& velocity_setpoint,
            const JointVector& torque, const ChainPose& pose) noexcept;

  const JointVector& q() const noexcept { return q_; }             ///< of the links
  const JointVector& qMotor() const noexcept { return q_motor_; }  ///< at the joint

 private:
  SerialChain chain_;
  ArmDynamicsConfig config_;
  JointVector servo_damping_, servo_stiffness_;
  JointVector q_, v_, q_motor_, v_motor_;
};

}  // namespace tactus
