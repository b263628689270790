#pragma once

#include <string>

#include "tactus/control/controller_config.h"

namespace tactus {

/// What becomes of a way that is followed without contacts.
struct Reach {
  std::string problem;      ///< why the tool does not get there; empty: it does
  double duration_s = 0.0;  ///< of the reference
  JointVector q_end;        ///< m or rad
};

/// From q to rest at a pose. The way may end at a joint's limit where another one would not.
Reach followTo(const ControllerConfig& config, const JointVector& q, const Pose& X_BaseTool,
               const ToolMotionLimits& limits, double period_s);

}  // namespace tactus
