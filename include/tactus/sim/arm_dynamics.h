#pragma once

#include <array>
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
  // What does not exist where it is empty; of one joint by zero, or infinite torque.
  JointVector max_torque{};        ///< of the servo, at the joint, Nm or N
  JointVector coulomb_friction{};  ///< of motor and gear, at the joint, Nm or N
  JointVector viscous_friction{};  ///< likewise, Nm s/rad or N s/m
  JointVector backlash{};          ///< whole play of a flexible gear, rad or m; needs a rotor
};

/// Rigid bodies behind servos and gears, without gravity, which the drives carry, and without
/// centrifugal forces, which are small at the speeds of contact. Per joint:
///   M(q) q_ddot = K (theta - q) + D (theta_dot - q_dot) + tau
///   J theta_ddot = J_s w_b ((v - theta_dot) + w_i (q_d - theta)) - K (theta - q) - D (...)
/// with J_s the joint's own inertia at the start, v the velocity setpoint, q_d the way that it was
/// to go. A rigid gear adds J to M. Integrated by implicit Euler in springs, dampers and servos,
/// which stands any stiffness; the torques tau of contacts count as they are at the step's start.
/// The servo's torque may be limited; what it could not go is caught up later. Friction,
/// -tau_c clamp(theta_dot / v_stick) - d theta_dot, acts on the motor; within its play a gear has
/// no torque. All of these are straight lines between corners of the speeds after the step: which
/// piece holds is guessed, solved for and corrected until it fits.
class ArmDynamics {
 public:
  /// Throws std::invalid_argument unless there is one entry a joint, M positive definite, and a
  /// rotor where there is backlash.
  ArmDynamics(const SerialChain& chain, const ArmDynamicsConfig& config, const JointVector& q);

  /// One step of at most step_s. q_desired: at its end; torque: of contacts, on the joints.
  void step(double step_s, const JointVector& q_desired, const JointVector& velocity_setpoint,
            const JointVector& torque, const ChainPose& pose) noexcept;

  const JointVector& q() const noexcept { return q_; }             ///< of the links
  const JointVector& qMotor() const noexcept { return q_motor_; }  ///< at the joint

 private:
  /// The pieces that hold for a joint: -1, 0 or 1.
  struct Pieces {
    int limit = 0;  ///< of the servo's torque
    int slip = 0;   ///< of friction; 0: it sticks
    int side = 0;   ///< of the play; 0: between its ends
  };
  struct Speeds {
    JointVector links, motors;
  };
  struct Setpoints {
    double step_s;
    const JointVector &q_desired, &velocity;
  };
  /// Times the step: torque = push - damping * speed after it.
  struct Drive {
    double push, damping;
  };
  struct Gear {
    double stiffness, damping, stretch;
  };

  Drive servo(const Setpoints& to, Eigen::Index i) const noexcept;
  Drive drive(const Setpoints& to, Eigen::Index i) const noexcept;
  Gear gear(Eigen::Index i) const noexcept;
  void solve(const Setpoints& to, MassMatrix A, JointVector b, Speeds& next) const noexcept;
  bool correct(const Setpoints& to, const Speeds& next) noexcept;

  SerialChain chain_;
  ArmDynamicsConfig config_;
  bool has_pieces_;
  std::array<Pieces, kMaxJoints> pieces_{};
  JointVector servo_damping_, servo_stiffness_;
  JointVector q_, v_, q_motor_, v_motor_;
};

}  // namespace tactus
