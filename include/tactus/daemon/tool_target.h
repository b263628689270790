#pragma once

#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"
#include "tactus/supervisor/tool_orders.h"

namespace tactus {

/// Where the tool is told to go.
struct ToolTarget {
  ToolOrder order;
  Pose X_BaseTool;
};

/// What a request or a waypoint says of it: to_m, rotate_rad, relative, to_posture, speeds and
/// pause. from: where relative ones count from, and what the task leaves free stays. Throws an
/// InputError where it is contradictory, out of range or not the task's.
ToolTarget toolTarget(const Scene& scene, const Json& request, const Pose& from,
                      ToolOrder::Kind kind);

}  // namespace tactus
