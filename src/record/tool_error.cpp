#include "tactus/record/tool_error.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/rotation.h"

namespace tactus {

Vector3 toolError(const TaskConfig& task, const TaskVector& w_d, const Vector3& p_BaseTool) {
  Vector3 error = Vector3::Zero();
  for (int i = 0; i < task.size; ++i) {
    const int component = task.components[i];
    if (component < 3) error[component] = w_d[i] - p_BaseTool[component];
  }
  return error;
}

void fillToolError(const ControllerConfig& config, CycleRecord& record) {
  ChainPose pose;
  config.chain.computePose(
      Eigen::Map<const Eigen::VectorXd>(record.q_measured, config.chain.size()), pose);
  const Vector3 p_BaseTool = framePosition(pose, config.chain.tip());
  const TaskVector w_d = Eigen::Map<const Eigen::VectorXd>(record.wd, config.task.size);
  Eigen::Map<Vector3>(record.tool_error_m) = toolError(config.task, w_d, p_BaseTool);
}

ToolRotationError::ToolRotationError(const ControllerConfig& config)
    : chain_(config.chain), task_(config.task) {
  if (task_.hasRotation())
    trajectory_.emplace(task_.trajectory, tipPose(config.chain, config.q_start));
}

Matrix3 ToolRotationError::desired(const CycleRecord& record) {
  if (!task_.commands) return trajectory_->evaluate(record.path_time_s).R_BaseTool;
  if (!motion_ || motion_->plan().number != record.tool_motion.number)
    motion_.emplace(record.tool_motion);
  return motion_->evaluate(record.path_time_s).R_BaseTool;
}

void ToolRotationError::fill(CycleRecord& record) {
  if (!trajectory_) return;
  const JointVector q = Eigen::Map<const Eigen::VectorXd>(record.q_measured, chain_.size());
  const Matrix3 R_BaseTool = tipPose(chain_, q).R_AB;
  const Vector3 error = rotationVector(desired(record) * R_BaseTool.transpose());
  double squared = 0.0;
  for (int i = 0; i < task_.size; ++i) {
    const int component = task_.components[i];
    if (component >= 3) squared += error[component - 3] * error[component - 3];
  }
  record.tool_rotation_error_rad = std::sqrt(squared);
}

}  // namespace tactus
