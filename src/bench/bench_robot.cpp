#include "tactus/bench/bench_robot.h"

#include <cmath>

namespace tactus {
namespace {

constexpr double kLinkLength_m = 0.2;

std::vector<Joint> makeJoints(int count) {
  const Vector3 axes[] = {Vector3::UnitZ(), Vector3::UnitY()};
  std::vector<Joint> joints(count);
  for (int i = 0; i < count; ++i) {
    joints[i].axis = axes[i % 2];
    joints[i].X_ParentJoint.p_AB = Vector3(i == 0 ? 0.0 : kLinkLength_m, 0.0, i == 0 ? 0.5 : 0.0);
  }
  return joints;
}

/// Far from singular for every number of joints, also with six task components.
JointVector makeStart(int count) {
  JointVector q(count);
  for (int i = 0; i < count; ++i) q[i] = 1.1 * std::sin(1.7 * i + 2.8);
  return q;
}

void addContact(int joints, ControllerConfig& config) {
  config.tactile_modules.emplace_back();
  config.tactile_modules.front().link.joint = joints / 2;
  config.tactile_modules.front().length_m = kLinkLength_m;
  config.force_control.emplace();
  config.force_control->variant = Variant::kNullTask;
  config.force_control->has_estimator = true;
}

}  // namespace

BenchRobot makeBenchRobot(int joints, int task_components, int contacts) {
  const std::vector<Joint> chain = makeJoints(joints);
  const Pose tool{Matrix3::Identity(), Vector3(kLinkLength_m, 0.0, 0.0)};
  ControllerConfig config{.chain = SerialChain(chain, {joints - 1, tool})};
  config.q_start = makeStart(joints);
  config.limits.upper = JointVector::Constant(joints, 2.0);
  config.limits.lower = -config.limits.upper;
  config.limits.max_velocity = JointVector::Constant(joints, 3.0);
  config.limits.max_acceleration = JointVector::Constant(joints, 50.0);
  config.task.size = task_components;
  for (int i = 0; i < task_components; ++i) config.task.components[i] = i;
  Waypoint line;
  line.displacement_m = Vector3(0.0, 0.1, 0.05);
  config.task.trajectory.waypoints = {line};
  config.weights = JointVector::Ones(joints);
  config.has_joint_limit_avoidance = true;
  if (contacts > 0) addContact(joints, config);
  return {chain, config};
}

RobotInput benchInput(const BenchRobot& robot, int cycle) {
  RobotInput input;
  input.q_measured = robot.config.q_start;
  if (robot.config.tactile_modules.empty()) return input;
  const int sample = cycle / 4 + 1;
  TactileSample& tactile = input.tactile[0];
  tactile.force_y_N = 2.5 + 0.5 * std::sin(0.3 * sample);
  tactile.force_z_N = 1.0;
  const double x_m = 0.4 * kLinkLength_m;
  tactile.moment_y_Nm = -x_m * tactile.force_z_N;
  tactile.moment_z_Nm = x_m * tactile.force_y_N;
  tactile.sequence = static_cast<std::uint32_t>(sample);
  return input;
}

}  // namespace tactus
