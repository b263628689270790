#include "tactus/math/mass_matrix.h"

namespace tactus {
namespace {

/// m (|p|^2 1 - p p^T): what a mass at p has about the origin.
Matrix3 pointInertia(double mass_kg, const Vector3& p) noexcept {
  return mass_kg * (p.squaredNorm() * Matrix3::Identity() - p * p.transpose());
}

/// A body about the origin of the base, in the base frame.
struct SpatialInertia {
  double mass_kg = 0.0;
  Vector3 moment = Vector3::Zero();  ///< mass times centre, kg m
  Matrix3 I_Origin = Matrix3::Zero();

  void add(const BodyInertia& body, const ChainPose& pose, int joint) noexcept {
    const Matrix3& R = pose.R_BaseJoint[joint];
    const Vector3 p_BaseCom = pointInBase(pose, joint, body.p_JointCom);
    mass_kg += body.mass_kg;
    moment += body.mass_kg * p_BaseCom;
    I_Origin += R * body.I_Com * R.transpose() + pointInertia(body.mass_kg, p_BaseCom);
  }
};

/// A motion of a body that covers the base's origin, or the momentum that goes with it.
struct Screw {
  Vector3 linear, angular;
};

Screw motionOf(const SerialChain& chain, const ChainPose& pose, int joint) noexcept {
  const Vector3 axis = pose.axis_Base[joint];
  if (chain.type(joint) == JointType::kPrismatic) return {axis, Vector3::Zero()};
  return {pose.p_BaseJoint[joint].cross(axis), axis};
}

Screw momentum(const SpatialInertia& body, const Screw& v) noexcept {
  return {body.mass_kg * v.linear + v.angular.cross(body.moment),
          body.I_Origin * v.angular + body.moment.cross(v.linear)};
}

}  // namespace

BodyInertia combined(const BodyInertia& a, const BodyInertia& b) noexcept {
  BodyInertia both;
  both.mass_kg = a.mass_kg + b.mass_kg;
  if (both.mass_kg > 0.0)
    both.p_JointCom = (a.mass_kg * a.p_JointCom + b.mass_kg * b.p_JointCom) / both.mass_kg;
  both.I_Com = a.I_Com + b.I_Com + pointInertia(a.mass_kg, a.p_JointCom - both.p_JointCom) +
               pointInertia(b.mass_kg, b.p_JointCom - both.p_JointCom);
  return both;
}

BodyInertia transformed(const Pose& X_AB, const BodyInertia& body) noexcept {
  return {body.mass_kg, X_AB.p_AB + X_AB.R_AB * body.p_JointCom,
          X_AB.R_AB * body.I_Com * X_AB.R_AB.transpose()};
}

void computeMassMatrix(const SerialChain& chain, const ChainPose& pose,
                       const std::vector<BodyInertia>& bodies, MassMatrix& M) noexcept {
  const int n = chain.size();
  M.resize(n, n);
  SpatialInertia outer;  // of all bodies from this joint on
  for (int i = n - 1; i >= 0; --i) {
    outer.add(bodies[i], pose, i);
    const Screw p = momentum(outer, motionOf(chain, pose, i));
    for (int j = 0; j <= i; ++j) {
      const Screw v = motionOf(chain, pose, j);
      M(i, j) = M(j, i) = v.linear.dot(p.linear) + v.angular.dot(p.angular);
    }
  }
}

MassMatrix massMatrixAt(const SerialChain& chain, const std::vector<BodyInertia>& bodies,
                        const JointVector& q) noexcept {
  ChainPose pose;
  chain.computePose(q, pose);
  MassMatrix M;
  computeMassMatrix(chain, pose, bodies, M);
  return M;
}

}  // namespace tactus
