#include "tactus/math/velocity_product.h"

namespace tactus {

VelocityProduct velocityProduct(const SerialChain& chain, const ChainPose& pose, int joint,
                                const Vector3& p_BasePoint, const JointVector& q_dot) noexcept {
  VelocityProduct result{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  Vector3& omega = result.omega;
  Vector3 p = Vector3::Zero();  // whatever the first joint's lever is: the base does not turn
  const auto goTo = [&](const Vector3& next) {
    const Vector3 lever = next - p;
    result.linear += result.angular.cross(lever) + omega.cross(omega.cross(lever));
    p = next;
  };
  for (int i = 0; i <= joint; ++i) {
    goTo(pose.p_BaseJoint[i]);
    const Vector3 motion = q_dot[i] * pose.axis_Base[i];
    if (chain.type(i) == JointType::kPrismatic) {
      result.linear += 2.0 * omega.cross(motion);
    } else {
      result.angular += omega.cross(motion);
      omega += motion;
    }
  }
  goTo(p_BasePoint);
  return result;
}

}  // namespace tactus
