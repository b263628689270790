#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// How far the tool is from its reference.
struct ToolLag {
  double position_m = 0.0, rotation_rad = 0.0;
};

/// error: of the task's components, m or rad.
ToolLag toolLag(const TaskConfig& task, const PaddedTaskVector& error) noexcept;

/// s(e) of TaskConfig: the share of its planned speed at which the reference goes on while the tool
/// lags by e = lag, 1 to 0. A lag that is NaN, as of a broken state, is no reason to wait.
double pathProgress(double lag, double wait_beyond) noexcept;

/// The lesser of those of position and orientation.
double pathProgress(const TaskGains& gains, const ToolLag& lag) noexcept;
/// Whether it is the orientation for which the reference waits, or waits longer.
bool waitsForTurn(const TaskGains& gains, const ToolLag& lag) noexcept;

}  // namespace tactus
