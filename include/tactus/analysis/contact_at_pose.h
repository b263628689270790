#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/math/contact_space.h"

namespace tactus {

/// A contact as the controller sees it in one pose of the arm.
struct ContactAtPose {
  ScaledVector inv_sqrt_weights;
  WeightedPseudoinverse pseudoinverse;
  ContactSpace space;  ///< without a motion of the task
};

/// a: J_p^T F^ of the contact, zero beyond the robot's joints.
ContactAtPose contactAtPose(const ControllerConfig& config, const ChainPose& pose,
                            const ScaledVector& a);

}  // namespace tactus
