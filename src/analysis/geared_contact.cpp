#include "tactus/analysis/geared_contact.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "tactus/analysis/cover_geometry.h"
#include "tactus/math/contact_space.h"

namespace tactus {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A motor without inertia would have no speed of its own; as a share of the joint's inertia.
constexpr double kLeastRotor = 1e-3;
constexpr double kImmovable = 1e-9;  ///< of what all joints can: the space does not move it

std::vector<Index> gearedJoints(const ArmDynamicsConfig& arm) {
  std::vector<Index> joints;
  for (Index i = 0; i < arm.gear_stiffness.size(); ++i)
    if (std::isfinite(arm.gear_stiffness[i])) joints.push_back(i);
  return joints;
}

MatrixXd taskJacobian(const ControllerConfig& config, const ChainPose& pose) {
  TaskJacobian J;
  computeTipJacobian(config.chain, pose, framePosition(pose, config.chain.tip()),
                     config.task.components.data(), config.task.size, J);
  return J;
}

/// Joint speeds with which this space answers a push along a.
VectorXd answer(const ControllerConfig& config, const ChainPose& pose, const VectorXd& a,
                AnswerSpace space) {
  const VectorXd in_joints = VectorXd(config.weights).cwiseInverse().cwiseProduct(a);
  if (space == AnswerSpace::kJoint) return in_joints;
  const MatrixXd J = taskJacobian(config, pose);
  const MatrixXd W_inv_JT = VectorXd(config.weights).cwiseInverse().asDiagonal() * J.transpose();
  const VectorXd in_task = W_inv_JT * (J * W_inv_JT).ldlt().solve(J * in_joints);
  return space == AnswerSpace::kTask ? in_task : VectorXd(in_joints - in_task);
}

}  // namespace

GearedContact gearedContact(const ControllerConfig& config, const ArmDynamicsConfig& arm,
                            const JointVector& q, const Vector3& n_Base, AnswerSpace space) {
  ChainPose pose;
  config.chain.computePose(q, pose);
  const TactileModuleConfig& module = config.tactile_modules.front();
  const CoverEnds cover = coverEnds(pose, module);
  ScaledVector a;
  applyPointJacobianTranspose(config.chain, pose, module.link.joint,
                              0.5 * (cover.p_BaseStart + cover.p_BaseEnd), n_Base, a);
  GearedContact contact;
  contact.arm = arm;
  contact.M = massMatrixAt(config.chain, arm.bodies, q);
  contact.a = a.head(config.chain.size());
  const VectorXd in_joints = answer(config, pose, contact.a, AnswerSpace::kJoint);
  const VectorXd way = answer(config, pose, contact.a, space);
  const double k = VectorXd(contact.a).dot(way);
  const double k_j = VectorXd(contact.a).dot(in_joints);
  contact.way = k > kImmovable * k_j ? JointVector(way * invertRegularised(k, k_j))
                                     : JointVector::Zero(q.size());
  return contact;
}

Eigen::MatrixXd gearedStep(const GearedContact& contact, double stiffness_ratio, double step_s) {
  const ArmDynamicsConfig& arm = contact.arm;
  const std::vector<Index> geared = gearedJoints(arm);
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

double firstGearMode_hz(const GearedContact& contact) {
  const std::vector<Index> geared = gearedJoints(contact.arm);
  if (geared.empty()) return std::numeric_limits<double>::infinity();
  const MatrixXd M = MatrixXd(contact.M)(geared, geared);
  const MatrixXd K = VectorXd(VectorXd(contact.arm.gear_stiffness)(geared)).asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(K, M, Eigen::EigenvaluesOnly);
  return std::sqrt(modes.eigenvalues().minCoeff()) / (2.0 * std::numbers::pi);
}

}  // namespace tactus
