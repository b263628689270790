#include "tactus/analysis/geared_contact.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "tactus/analysis/contact_at_pose.h"
#include "tactus/analysis/cover_geometry.h"

namespace tactus {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A motor without inertia would have no speed of its own; as a share of the joint's inertia.
constexpr double kLeastRotor = 1e-3;
constexpr double kImmovable = 1e-9;  ///< of what all joints can: the space does not move it

std::vector<Index> gearedJoints(const JointVector& gear_stiffness) {
  std::vector<Index> joints;
  for (Index i = 0; i < gear_stiffness.size(); ++i)
    if (std::isfinite(gear_stiffness[i])) joints.push_back(i);
  return joints;
}

/// The motion W^-1/2 v^ of a space that answers a push, for each m of the contact's way.
struct Answer {
  ScaledVector v_scaled;
  double k;  ///< a^T of it, before it is divided
};

Answer answerIn(AnswerSpace space, const WeightedPseudoinverse& pseudoinverse,
                const ContactSpace& contact) {
  const ScaledVector in_task = pseudoinverse.expand(contact.a_task);
  switch (space) {
    case AnswerSpace::kNull:
      return {contact.a_scaled - in_task, contact.k_n};
    case AnswerSpace::kTask:
      return {in_task, contact.k_t};
    case AnswerSpace::kJoint:
      break;
  }
  return {contact.a_scaled, contact.k_j};
}

/// As the controller answers: `way` of GearedContact.
JointVector wayOf(AnswerSpace space, const ControllerConfig& config, const ChainPose& pose,
                  const ScaledVector& a) {
  const ContactAtPose seen = contactAtPose(config, pose, a);
  const Answer answer = answerIn(space, seen.pseudoinverse, seen.space);
  if (answer.k <= kImmovable * seen.space.k_j) return JointVector::Zero(config.chain.size());
  const ScaledVector way = invertRegularised(answer.k, seen.space.k_j) *
                           seen.inv_sqrt_weights.cwiseProduct(answer.v_scaled);
  return way.head(config.chain.size());
}

}  // namespace

GearedContact gearedContact(const ControllerConfig& config, const ArmDynamicsConfig& arm,
                            const JointVector& q, const Vector3& n_Base, AnswerSpace space,
                            int index) {
  ChainPose pose;
  config.chain.computePose(q, pose);
  const TactileModuleConfig& module = config.tactile_modules[index];
  const CoverEnds cover = coverEnds(pose, module);
  ScaledVector a;
  applyPointJacobianTranspose(config.chain, pose, module.link.joint,
                              0.5 * (cover.p_BaseStart + cover.p_BaseEnd), n_Base, a);
  GearedContact contact;
  contact.arm = arm;
  contact.M = massMatrixAt(config.chain, arm.bodies, q);
  contact.a = a.head(config.chain.size());
  contact.way = wayOf(space, config, pose, a);
  return contact;
}

Eigen::MatrixXd gearedStep(const GearedContact& contact, double stiffness_ratio, double step_s) {
  const ArmDynamicsConfig& arm = contact.arm;
  const std::vector<Index> geared = gearedJoints(arm.gear_stiffness);
  const Index n = contact.a.size();
  const auto m = static_cast<Index>(geared.size());
  const Index theta = n, v = n + m, w = 2 * n + m, p = 2 * n + 2 * m, u = p + 1;
  const Index size = u + 1;
  MatrixXd M = contact.M;
  MatrixXd forces = MatrixXd::Zero(n, size);  // on the links
  const VectorXd a = contact.a;
  forces.leftCols(n) = -stiffness_ratio * contact.law_N_per_m * a * a.transpose();
  MatrixXd motor_forces = MatrixXd::Zero(m, size);
  VectorXd rotors(m);
  const double w_b = 2.0 * std::numbers::pi * arm.servo_bandwidth_hz;
  const double w_i = 2.0 * std::numbers::pi * arm.servo_integral_hz;
  Index k = 0;
  for (Index i = 0; i < n; ++i) {
    const double J_servo = contact.M(i, i) + arm.rotor_inertia[i];
    const bool is_geared = std::isfinite(arm.gear_stiffness[i]);
    auto servo = is_geared ? motor_forces.row(k) : forces.row(i);
    const Index place = is_geared ? theta + k : i;
    const Index speed = is_geared ? w + k : v + i;
    servo[u] += w_b * J_servo * contact.way[i];
    servo[speed] -= w_b * J_servo;
    servo[p] += w_i * w_b * J_servo * contact.way[i];
    servo[place] -= w_i * w_b * J_servo;
    if (!is_geared) {
      M(i, i) += arm.rotor_inertia[i];
      continue;
    }
    const double K = arm.gear_stiffness[i];
    const double D = arm.gear_damping[i];
    for (const auto& [column, factor] : {std::pair{place, K}, {speed, D}, {i, -K}, {v + i, -D}}) {
      forces(i, column) += factor;
      motor_forces(k, column) -= factor;
    }
    rotors[k++] = std::max(arm.rotor_inertia[i], kLeastRotor * J_servo);
  }
  MatrixXd A = MatrixXd::Zero(size, size);
  A.block(0, v, n, n).setIdentity();
  A.block(theta, w, m, m).setIdentity();
  A.middleRows(v, n) = M.llt().solve(forces);
  A.middleRows(w, m) = rotors.cwiseInverse().asDiagonal() * motor_forces;
  A(p, u) = 1.0;
  return (step_s * A).exp();
}

VectorXd gearModes_hz(const MassMatrix& M, const JointVector& gear_stiffness) {
  const std::vector<Index> geared = gearedJoints(gear_stiffness);
  const MatrixXd K = VectorXd(VectorXd(gear_stiffness)(geared)).asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(K, MatrixXd(M)(geared, geared),
                                                                 Eigen::EigenvaluesOnly);
  return modes.eigenvalues().cwiseSqrt() / (2.0 * std::numbers::pi);
}

}  // namespace tactus
