#include "tactus/scene/task_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/math/rotation.h"

namespace tactus {
namespace {

bool isOfPosition(int component) { return component < 3; }

void checkComponents(const CheckedScene& c) {
  const std::size_t joint_count = c.robot.chain.joints.size();
  const TaskConfig& task = c.scene.task;
  if (static_cast<std::size_t>(task.size) > joint_count) {
    c.fail("task.components", fmt::format("a list of {}", task.size),
           fmt::format("at most {}, as many as there are joints", joint_count));
  }
  if (c.scene.gains.task.wait_beyond_m < kNoLimit && !task.hasPosition()) {
    c.fail("task.wait_beyond_m", "the task has no position that could lag",
           "x, y or z among task.components, or no such key");
  }
  if (c.scene.gains.task.wait_beyond_rad < kNoLimit && !task.hasRotation()) {
    c.fail("task.wait_beyond_rad", "the task has no orientation that could lag",
           "rx, ry or rz among task.components, or no such key");
  }
}

/// A sound bound, not a sharp one: how far from the base's origin the tool can ever be.
double largestReach_m(const UrdfChain& chain) {
  double reach = chain.tip.X_JointFrame.p_AB.norm();
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    reach += chain.joints[i].X_ParentJoint.p_AB.norm();
    if (chain.joints[i].type == JointType::kPrismatic) {
      reach += std::max(std::abs(chain.limits.lower[i]), std::abs(chain.limits.upper[i]));
    }
  }
  return reach;
}

void checkReach(const CheckedScene& c, const Waypoint& waypoint, const std::string& path) {
  const UrdfChain& chain = c.robot.chain;
  const SerialChain kinematics(chain.joints, chain.tip);
  ChainPose pose;
  kinematics.computePose(c.q_start, pose);
  const Vector3 target = framePosition(pose, chain.tip) + waypoint.displacement_m;
  double squared_distance = 0.0;
  for (int i = 0; i < c.scene.task.size; ++i) {
    const int axis = c.scene.task.components[i];
    if (isOfPosition(axis)) squared_distance += target[axis] * target[axis];
  }
  const double distance = std::sqrt(squared_distance);
  if (distance > largestReach_m(chain)) {
    c.fail(path + ".displacement_m", fmt::format("leads {:.3f} m away from the base", distance),
           fmt::format("at most the arm's reach of {:.3f} m", largestReach_m(chain)));
  }
}

void checkWaypoint(const CheckedScene& c, const Waypoint& waypoint, const std::string& path) {
  checkReach(c, waypoint, path);
  const double angle = waypoint.rotation_vector_rad.norm();
  if (angle > kMostTurn_rad) {
    c.fail(path + ".rotation_vector_rad", fmt::format("turns by {:.16g} rad", angle),
           "less than half a turn, at most 3.14159265 rad: that has no sense of rotation");
  }
  if (angle > 0.0 && !c.scene.task.hasRotation()) {
    c.fail(path + ".rotation_vector_rad", "the task does not control the orientation",
           "rx, ry or rz among task.components, or no such key");
  }
}

/// A tool that is held off must not be told to go further and further away.
void checkCommands(const CheckedScene& c) {
  if (c.scene.trajectory)
    c.fail("task.trajectory", "a trajectory besides task.source: commands",
           "one of both; trajectory: ~ drops what this scene extends");
  if (!c.scene.controller || c.scene.controller->variant == Variant::kNone) return;
  const TaskGains& gains = c.scene.gains.task;
  if (!c.scene.task.hasPosition())
    c.fail("task.components", "no position, whose lag a task by commands waits for",
           "x, y or z among them");
  if (gains.wait_beyond_m == kNoLimit)
    c.fail("task.wait_beyond_m", "is missing", "a lag for a task by commands, such as 0.02");
  if (gains.max_return_speed_m_per_s == kNoLimit)
    c.fail("task.max_return_speed_m_per_s", "is missing",
           "a speed for a task by commands, such as 0.05");
  if (c.scene.task.hasRotation() && gains.max_return_speed_rad_per_s == kNoLimit)
    c.fail("task.max_return_speed_rad_per_s", "is missing",
           "a speed for a task by commands with a rotation, such as 0.2");
}

void checkTrajectory(const CheckedScene& c) {
  if (c.scene.source == TaskSource::kCommands) return checkCommands(c);
  if (c.scene.task.commands)
    c.fail("task.commands", "is of no use", "task.source: commands besides");
  const std::string section = "task.trajectory";
  if (!c.scene.trajectory) c.fail(section, "is missing", "a section, or task.source: commands");
  const TrajectorySection& trajectory = *c.scene.trajectory;
  std::vector<std::string> given;
  if (trajectory.line) given.push_back("line");
  if (!trajectory.waypoints.empty()) given.push_back("waypoints");
  if (trajectory.hold) given.push_back("hold");
  if (given.empty()) c.fail(section, "no motion", "one of line, waypoints, hold");
  if (given.size() > 1) {
    c.fail(section + "." + given[1], "a second kind of motion besides " + given[0],
           "one of line, waypoints, hold");
  }
  for (std::size_t i = 0; i < trajectory.waypoints.size(); ++i) {
    checkWaypoint(c, trajectory.waypoints[i], fmt::format("{}.waypoints[{}]", section, i));
  }
  if (!trajectory.line) return;
  const std::string path = section + ".line";
  checkWaypoint(c, *trajectory.line, path);
  if (trajectory.line->displacement_m.isZero(0.0) &&
      trajectory.line->rotation_vector_rad.isZero(0.0)) {
    c.fail(path, "does not move", "displacement_m or rotation_vector_rad, or hold");
  }
}

}  // namespace

void CheckedScene::fail(const std::string& path, const std::string& problem,
                        const std::string& expectation) const {
  failAt(locate(root, path), path, problem, "expected " + expectation);
}

void checkTask(const CheckedScene& checked) {
  checkComponents(checked);
  checkTrajectory(checked);
}

}  // namespace tactus
