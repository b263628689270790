#pragma once

#include <string>

#include "tactus/scene/scene.h"

namespace tactus {

/// Where the arm is, m or rad: opens the scene's buses, sets the drives up without torque, and lets
/// them go. Beside a limit by no more than start_tolerance counts as on it. Throws RunError with
/// what is wrong, as the daemon would name it.
JointVector readJoints(const Scene& scene);

/// "[0.1, -0.25]", as a scene's `start` has it.
std::string startText(const JointVector& q);

}  // namespace tactus
