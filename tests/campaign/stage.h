#pragma once

#include <string>
#include <vector>

#include "campaign/judges.h"
#include "support/virtual_robot_cell.h"
#include "tactus/scene/scene.h"

namespace tactus::campaign {

using test::VirtualRobotCell;

/// A variant's scene and the cells from which its runs begin.
struct Stage {
  Scene scene;
  Promise promise;
  std::vector<VirtualRobotCell> moments;  ///< by Moment
};

/// Scenario 1 with e-stop, enable line and brake.
Scene campaignScene(const std::string& variant);
/// cell: of that scene.
Promise promiseOf(const Scene& scene, const VirtualRobotCell& cell);
Stage bootStage(const std::string& variant);

}  // namespace tactus::campaign
