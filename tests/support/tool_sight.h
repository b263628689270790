#pragma once

#include <algorithm>

#include "tactus/control/controller_config.h"
#include "tactus/supervisor/tool_orders.h"

namespace tactus::test {

/// The arm at its start.
inline void placeAtStart(const ControllerConfig& config, bool is_running, ToolSight& sight) {
  const Pose X = tipPose(config.chain, config.q_start);
  sight.is_running = is_running;
  std::copy_n(config.q_start.data(), config.q_start.size(), sight.q);
  std::copy_n(X.p_AB.data(), 3, sight.p_BaseTool_m);
  std::copy_n(X.R_AB.data(), 9, sight.R_BaseTool);
}

}  // namespace tactus::test
