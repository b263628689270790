#include "tactus/control/controller.h"
#include "tactus/math/rotation.h"

/// What a controller makes of a task with one or two of rx, ry, rz: see TaskConfig. R_e = R_d R^T,
/// and phi is its rotation vector.
namespace tactus {
namespace {

constexpr int kRotation[] = {3, 4, 5};

}  // namespace

/// Of J their rows are set; w_dot_d of all three, whose others nobody looks at.
Vector3 Controller::keepPartOfRotation(const ChainPose& pose, const Vector3& phi,
                                       const Vector3& omega_d, ScaledJacobian& J) const noexcept {
  ScaledJacobian J_omega;
  computeTipJacobian(config_.chain, pose, Vector3::Zero(), kRotation, 3, inv_sqrt_weights_,
                     J_omega);
  const Matrix3 Jl_inverse = inverseLeftJacobian(phi);
  for (int i = 0; i < config_.task.size; ++i) {
    const int k = config_.task.components[i] - 3;
    if (k >= 0) J.col(i) = J_omega.leftCols<3>() * Jl_inverse.col(k);
  }
  return Jl_inverse * omega_d;
}

/// phi_dd + Jl^-T J_omega q_dd, which is what is left of phi_dd = 0 but for the joints:
///   Jl^-1 alpha_d + Jl^-T (omega x R_e^T omega_d - J_omega_dot q_dot) + d/dt(Jl^-T) u
/// with u = R_e^T omega_d - omega and phi_dot = Jl^-T u. alpha_d: rad/s^2, with the reference's
/// progress.
Vector3 Controller::partOfRotationAcceleration(double path_time_s, double progress,
                                               const Vector3& alpha_d,
                                               const VelocityProduct& curvature,
                                               const ChainPose& pose,
                                               const ControllerState& state) const noexcept {
  const ToolReference reference = referenceAt(path_time_s, state);
  const Matrix3 R_e = reference.R_BaseTool * framePose(pose, config_.chain.tip()).R_AB.transpose();
  const Vector3 phi = rotationVector(R_e);
  const Vector3 omega_d = progress * (R_e.transpose() * reference.omega_BaseTool);
  const Vector3 u = omega_d - curvature.omega;
  const Matrix3 Jl_inverse = inverseLeftJacobian(phi);
  const Vector3 phi_dot = Jl_inverse.transpose() * u;
  return Jl_inverse * alpha_d +
         Jl_inverse.transpose() * (curvature.omega.cross(omega_d) - curvature.angular) +
         inverseLeftJacobianRate(phi, phi_dot).transpose() * u;
}

}  // namespace tactus
