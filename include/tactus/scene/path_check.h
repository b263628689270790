#pragma once

#include <string>
#include <vector>

#include "tactus/scene/scene.h"

namespace tactus {

/// What is doubtful about the motion of a scene: a start near a singularity, a path that the joints
/// cannot follow or the simulation does not reach the end of, obstacles that nothing feels, a cover
/// whose weight is taken for a contact. For people, to be printed as warnings.
std::vector<std::string> checkPath(const Scene& scene);

/// Smallest singular value of J W^-1/2 where the task starts. weights: positive.
double smallestSingularValueAtStart(const ControllerConfig& config, const JointVector& weights);

}  // namespace tactus
