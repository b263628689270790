#pragma once

#include <string>

#include "tactus/scene/scene.h"

namespace tactus {

/// Throws InputError if the scene starts measured without an enable line.
void checkMeasuredStart(const Scene& scene);

/// Where the arm is, m or rad: opens the scene's buses, sets the drives up without torque, and lets
/// them go. Throws RunError with what is wrong, as the daemon would name it.
JointVector readJoints(const Scene& scene);

/// Where an arm at q may start: a joint beyond its limit by no more than start_tolerance counts as
/// on it.
JointVector startAt(const Scene& scene, const JointVector& q);

/// "[0.1, -0.25]", as a scene's `start` has it.
std::string startText(const JointVector& q);

}  // namespace tactus
