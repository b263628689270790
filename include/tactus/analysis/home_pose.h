#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// Where an arm may start from, and what its tool can be told to do there.
struct HomePose {
  JointVector q;  ///< m or rad, round numbers
  /// Of x, y, z as many as the arm controls well there; only where it is none, one rotation.
  TaskConfig task;
  double smallest_singular_value = 0.0;  ///< of the task's Jacobian
};

/// The best of a fixed set of poses in the inner half of each joint's range, and not far from zero:
/// with the largest smallest singular value. The same for the same arm. Knows nothing of what the
/// arm may run into, itself included.
HomePose findHome(const SerialChain& chain, const JointLimits& limits);

/// A straight motion of one component of the task from a home pose, at most 0.05 m at 0.02 m/s, or
/// 0.1 rad at 0.05 rad/s: the one of which there is most room, where each joint keeps three
/// quarters of its way to the limit and four fifths of its largest speed, by the Jacobian of the
/// start.
Waypoint findFirstMotion(const SerialChain& chain, const JointLimits& limits, const HomePose& home);

}  // namespace tactus
