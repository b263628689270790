#pragma once

#include "tactus/control/body_distances.h"

namespace tactus {

// clang-format off: equations
/// What keeps an arm clear early, in the null space, as JointLimitAvoidance does: with
///   H = 1/2 sum (d_a - d)^2 / l^2 of all near bodies with d < d_a,   l = 0.3 m
/// it gives W^-1/2 alpha dH/dq, of which N is subtracted, so a distance to which the joints have
/// levers of l grows by alpha (d_a - d). Steepest in the metric of W, so where it comes to rest
/// does not depend on W. Of a pair that is nearly parallel the ends of the stretch where one is
/// beside the other, half each, take the nearest point's place: see NearStretch.
// clang-format on
ScaledVector clearanceCost(const ClearanceAvoidance& avoid, const BodyDistances& distances,
                           const ChainPose& pose, const NearBodies& near,
                           const ScaledVector& inv_sqrt_weights) noexcept;

}  // namespace tactus
