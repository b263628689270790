#include "tactus/analysis/contact_at_pose.h"

namespace tactus {

ContactAtPose contactAtPose(const ControllerConfig& config, const ChainPose& pose,
                            const ScaledVector& a) {
  ContactAtPose contact{};
  contact.inv_sqrt_weights =
      scaled(config.weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones());
  ScaledJacobian J;
  computeTipJacobian(config.chain, pose, framePosition(pose, config.chain.tip()),
                     config.task.components.data(), config.task.size, contact.inv_sqrt_weights, J);
  contact.pseudoinverse.factorise(J, config.chain.size(), config.task.size);
  computeContactSpace(contact.pseudoinverse, a, contact.inv_sqrt_weights, PaddedTaskVector::Zero(),
                      contact.space);
  return contact;
}

}  // namespace tactus
