#pragma once

#include <string>

#include "tactus/control/controller_config.h"

namespace tactus {

/// Why the tool would not get to a pose: the motion there is followed from q, without contacts, to
/// its end, which may be a local one. Empty: it gets there, in `duration_s`.
std::string findUnreachable(const ControllerConfig& config, const JointVector& q,
                            const Pose& X_BaseTool, const ToolMotionLimits& limits, double period_s,
                            double& duration_s);

}  // namespace tactus
