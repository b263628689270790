#pragma once

#include <string>
#include <vector>

#include "tactus/analysis/cover_geometry.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// The cover of a module that the controller reads, where the scene starts.
struct CoverReport {
  std::string link;
  CoverEnds ends;
};

std::vector<CoverReport> coversAtStart(const Scene& scene);

/// What is doubtful about an arm: links and covers of a size or in a place that no robot has,
/// joint limits that look like degrees, accelerations that its drives have no torque for, drives
/// that lag behind for good, a start that tactusd refuses. For people, to be printed as warnings.
std::vector<std::string> checkArm(const Scene& scene);

}  // namespace tactus
