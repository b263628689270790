#pragma once

#include <Eigen/Core>

#include "tactus/control/controller_config.h"
#include "tactus/sim/arm_dynamics.h"

namespace tactus {

/// A contact point that motors move through servos and gears, and a spring holds back; at one
/// posture, linear. The model is that of ArmDynamics.
struct GearedContact {
  ArmDynamicsConfig arm;
  MassMatrix M;     ///< there, without rotors
  JointVector a;    ///< x = a^T q
  JointVector way;  ///< of the motors for each m of x that the law commands; a^T way = 1 or less
  double law_N_per_m = 1.0;  ///< c, which stiffness ratios are of
};

/// In which joints a law lets a contact give way.
enum class AnswerSpace { kNull, kJoint, kTask };

/// The contact of a module in the middle of its cover, pushed along n_Base (unit vector,
/// base frame), at q. `way` is zero where that space does not move the contact.
GearedContact gearedContact(const ControllerConfig& config, const ArmDynamicsConfig& arm,
                            const JointVector& q, const Vector3& n_Base, AnswerSpace space,
                            int module = 0);

/// What a step of step_s makes of [link positions, motor positions, link speeds, motor speeds,
/// commanded x, commanded speed] with a spring of stiffness_ratio c at the contact; the speed stays
/// the same. Of rigid joints the motor is the link: their motors are left out. Exact.
Eigen::MatrixXd gearedStep(const GearedContact& contact, double stiffness_ratio, double step_s);

/// Of the links behind motors that are held fast, Hz, slowest first; one at
/// least is finite.
Eigen::VectorXd gearModes_hz(const MassMatrix& M, const JointVector& gear_stiffness);

}  // namespace tactus
