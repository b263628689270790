#include "tactus/record/tool_error.h"

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

}  // namespace tactus
