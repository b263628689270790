#pragma once

#include <optional>

#include "tactus/control/controller_config.h"
#include "tactus/supervisor/cycle_record.h"

namespace tactus {

/// Desired minus actual tool position, base frame, m, in the directions that belong to the task.
Vector3 toolError(const TaskConfig& task, const TaskVector& w_d, const Vector3& p_BaseTool);

/// Fills in tool_error_m of a record by its own q_measured; left to the telemetry, which has time.
void fillToolError(const ControllerConfig& config, CycleRecord& record);

/// How far the tool is turned from its reference.
class ToolRotationError {
 public:
  explicit ToolRotationError(const ControllerConfig& config);

  /// Fills in tool_rotation_error_rad of a record by its own q_measured and path_time_s: the length
  /// of what belongs to the task of the rotation vector of R_d R^T, base frame. Leaves it where the
  /// task has no rotation.
  void fill(CycleRecord& record);

 private:
  Matrix3 desired(const CycleRecord& record);

  SerialChain chain_;
  TaskConfig task_;
  std::optional<Trajectory> trajectory_;  ///< of a task with a rotation
  std::optional<ToolMotion> motion_;      ///< of one by command, as last seen
};

}  // namespace tactus
