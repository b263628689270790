#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// How far the tool is from its reference, m; error: of the task's components.
double toolLag_m(const TaskConfig& task, const PaddedTaskVector& error) noexcept;

/// s(e) of TaskConfig: the share of its planned speed at which the reference goes on while the tool
/// lags by e = lag_m, 1 to 0. A lag that is NaN, as of a broken state, is no reason to wait.
double pathProgress(double lag_m, double wait_beyond_m) noexcept;

}  // namespace tactus
