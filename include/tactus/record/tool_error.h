#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/supervisor/cycle_record.h"

namespace tactus {

/// Desired minus actual tool position, base frame, m, in the directions that belong to the task.
Vector3 toolError(const TaskConfig& task, const TaskVector& w_d, const Vector3& p_BaseTool);

/// Fills in tool_error_m of a record by its own q_measured; left to the telemetry, which has time.
void fillToolError(const ControllerConfig& config, CycleRecord& record);

}  // namespace tactus
