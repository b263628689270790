#include "tactus/record/tool_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/crops9.h"
#include "tactus/math/rotation.h"

namespace tactus {
namespace {

constexpr double kTurn_rad = 0.1;

ControllerConfig poseTask(const std::vector<int>& components) {
  ControllerConfig config = test::crops9Controller();
  config.task.size = static_cast<int>(components.size());
  std::copy(components.begin(), components.end(), config.task.components.begin());
  return config;
}

/// The last joint turned against the start.
CycleRecord turnedRecord(const ControllerConfig& config) {
  CycleRecord record;
  Eigen::Map<Eigen::VectorXd>(record.q_measured, 9) = config.q_start;
  record.q_measured[8] += kTurn_rad;
  return record;
}

double rotationErrorOf(const ControllerConfig& config, CycleRecord record) {
  ToolRotationError(config).fill(record);
  return record.tool_rotation_error_rad;
}

TEST(ToolRotationError, IsTheAngleBetweenArmAndReference) {
  const ControllerConfig config = poseTask({0, 1, 2, 3, 4, 5});
  EXPECT_NEAR(rotationErrorOf(config, turnedRecord(config)), kTurn_rad, 1e-12);
}

TEST(ToolRotationError, CountsWhatBelongsToTheTask) {
  const ControllerConfig config = poseTask({0, 1, 2, 3, 4, 5});
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  const Vector3 axis = framePose(pose, {8, {}}).R_AB.col(1);  // joint 9 turns about its y
  ASSERT_GT(std::abs(axis.z()), 0.05);
  ASSERT_GT(std::abs(axis.x()), 0.05);
  const CycleRecord record = turnedRecord(config);
  EXPECT_NEAR(rotationErrorOf(poseTask({5}), record), kTurn_rad * std::abs(axis.z()), 1e-12);
  EXPECT_NEAR(rotationErrorOf(poseTask({3, 0, 5}), record),
              kTurn_rad * std::hypot(axis.x(), axis.z()), 1e-12);
}

TEST(ToolRotationError, FollowsTheReferencesClock) {
  ControllerConfig config = poseTask({0, 1, 2, 3, 4, 5});
  config.task.trajectory.waypoints[0].rotation_vector_rad = Vector3(0.0, 0.3, 0.4);
  CycleRecord record;
  Eigen::Map<Eigen::VectorXd>(record.q_measured, 9) = config.q_start;
  record.task_time_s = 1000.0;
  EXPECT_NEAR(rotationErrorOf(config, record), 0.0, 1e-12);
  record.path_time_s = 1000.0;
  EXPECT_NEAR(rotationErrorOf(config, record), 0.5, 1e-12);
}

TEST(ToolRotationError, IsNotOfATaskWithoutRotation) {
  const ControllerConfig config = poseTask({0, 1, 2});
  CycleRecord record = turnedRecord(config);
  record.tool_rotation_error_rad = 7.0;
  EXPECT_EQ(rotationErrorOf(config, record), 7.0);
}

}  // namespace
}  // namespace tactus
