#pragma once

#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/motion.h"

namespace tactus::test {

/// Pose and pseudoinverse of an arm at q, as the controller has them.
inline void computeTaskKinematics(const SerialChain& chain, const JointVector& q,
                                  const std::vector<int>& components,
                                  const ScaledVector& inv_sqrt_weights,
                                  TaskKinematics& kinematics) {
  chain.computePose(q, kinematics.pose);
  const auto size = static_cast<int>(components.size());
  ScaledJacobian J;
  computeTipJacobian(chain, kinematics.pose, framePosition(kinematics.pose, chain.tip()),
                     components.data(), size, inv_sqrt_weights, J);
  kinematics.pseudoinverse.factorise(J, chain.size(), size);
}

inline void computeTaskKinematics(const ControllerConfig& config, const JointVector& q,
                                  const ScaledVector& inv_sqrt_weights,
                                  TaskKinematics& kinematics) {
  const int* const first = config.task.components.data();
  computeTaskKinematics(config.chain, q, {first, first + config.task.size}, inv_sqrt_weights,
                        kinematics);
}

}  // namespace tactus::test
