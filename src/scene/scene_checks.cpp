#include "tactus/scene/scene_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/scene/gain_keys.h"

namespace tactus {
namespace {

/// What the checks look at.
struct Checked {
  const YamlNode& root;
  const ConfigDraft& draft;
  const LoadedRobot& robot;
  const JointVector& q_start;

  [[noreturn]] void fail(const std::string& path, const std::string& problem,
                         const std::string& expectation) const {
    failAt(locate(root, path), path, problem, "expected " + expectation);
  }
};

void checkTask(const Checked& c) {
  const std::size_t joint_count = c.robot.chain.joints.size();
  if (c.draft.components.size() > joint_count) {
    c.fail("task.components", fmt::format("a list of {}", c.draft.components.size()),
           fmt::format("at most {}, as many as there are joints", joint_count));
  }
  const bool has_position = std::ranges::any_of(
      c.draft.components, [](const std::string& component) { return component.size() == 1; });
  if (c.draft.gains.task.wait_beyond_m < kNoLimit && !has_position) {
    c.fail("task.wait_beyond_m", "the task has no position that could lag",
           "x, y or z among task.components, or no such key");
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

void checkReach(const Checked& c, const Waypoint& waypoint, const std::string& path) {
  const UrdfChain& chain = c.robot.chain;
  const SerialChain kinematics(chain.joints, chain.tip);
  ChainPose pose;
  kinematics.computePose(c.q_start, pose);
  const Vector3 target = framePosition(pose, chain.tip) + waypoint.displacement_m;
  double squared_distance = 0.0;
  for (const std::string& component : c.draft.components) {
    const std::size_t axis = component.size() == 1 ? component[0] - 'x' : 3;
    if (axis < 3) squared_distance += target[axis] * target[axis];
  }
  const double distance = std::sqrt(squared_distance);
  if (distance > largestReach_m(chain)) {
    c.fail(path + ".displacement_m", fmt::format("leads {:.3f} m away from the base", distance),
           fmt::format("at most the arm's reach of {:.3f} m", largestReach_m(chain)));
  }
}

void checkTrajectory(const Checked& c) {
  const std::string section = "task.trajectory";
  std::vector<std::string> given;
  for (const char* kind : {"line", "waypoints", "hold"}) {
    if (findGiven(c.root, section + "." + kind)) given.push_back(kind);
  }
  if (given.empty()) c.fail(section, "no motion", "one of line, waypoints, hold");
  if (given.size() > 1) {
    c.fail(section + "." + given[1], "a second kind of motion besides " + given[0],
           "one of line, waypoints, hold");
  }
  const std::vector<Waypoint>& waypoints = c.draft.task.trajectory.waypoints;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const bool is_line = given[0] == "line";
    const std::string path =
        is_line ? section + ".line" : fmt::format("{}.waypoints[{}]", section, i);
    checkReach(c, waypoints[i], path);
    const double angle = waypoints[i].rotation_vector_rad.norm();
    if (angle > std::numbers::pi) {
      c.fail(path + ".rotation_vector_rad", fmt::format("turns by {:.4g} rad", angle),
             "at most half a turn");
    }
    if (is_line && waypoints[i].displacement_m.isZero(0.0) &&
        waypoints[i].rotation_vector_rad.isZero(0.0)) {
      c.fail(section + ".line", "does not move", "displacement_m or rotation_vector_rad, or hold");
    }
  }
}

void checkJointSpace(const Checked& c) {
  if (!findGiven(c.root, "redundancy.joint_limit_avoidance")) {
    c.fail(
        "redundancy.joint_limit_avoidance", "is missing",
        "a section with the variant joint_space, whose pull would drive joints onto their limits");
  }
}

void checkController(const Checked& c) {
  if (!findGiven(c.root, "controller")) return;
  if (!findGiven(c.robot.root, "tactile_module")) {
    c.fail("controller", "the robot has no tactile_module", "no controller, or such a robot");
  }
  const bool is_multi_space = c.draft.variant == "null_task" || c.draft.variant == "null_joint" ||
                              c.draft.variant == "null_limit";
  if (is_multi_space && !findGiven(c.root, "controller.activation_force_N")) {
    c.fail("controller.activation_force_N", "is missing",
           fmt::format("a number > 0 in N with the variant {}", c.draft.variant));
  }
  if (c.draft.variant == "joint_space") checkJointSpace(c);
  if (c.draft.variant != "none" && !findGiven(c.root, "stiffness")) {
    c.fail("stiffness", "is missing",
           fmt::format("a section with the variant {}", c.draft.variant));
  }
}

/// A run takes a few bytes of memory and some hundred of its log for every cycle.
void checkDuration(const Checked& c) {
  constexpr double kMaxCycles = 1e8;
  const std::string key = "simulation.duration_s";
  if (c.draft.duration_s < c.draft.period_s) {
    c.fail(key, fmt::format("{} s is shorter than a cycle", c.draft.duration_s),
           fmt::format("at least period_s = {}", c.draft.period_s));
  }
  if (c.draft.duration_s > kMaxCycles * c.draft.period_s) {
    c.fail(key, fmt::format("{} s is more than {:g} cycles", c.draft.duration_s, kMaxCycles),
           fmt::format("at most {} s with period_s = {}", kMaxCycles * c.draft.period_s,
                       c.draft.period_s));
  }
}

void checkSimulatedModule(const Checked& c) {
  const std::string key = "simulation.tactile_module.filter_cutoff_hz";
  const double limit_hz = 0.5 * c.draft.plant.module.filter_rate_hz;
  if (findGiven(c.root, key) && c.draft.simulated_filter_cutoff_hz >= limit_hz) {
    c.fail(key, fmt::format("{} Hz is too high", c.draft.simulated_filter_cutoff_hz),
           fmt::format("less than half the filter's rate, {} Hz", limit_hz));
  }
}

/// The simulated module filters a whole number of times a cycle, or once in a whole number of them.
void checkPeriod(const Checked& c) {
  if (!findGiven(c.root, "controller")) return;
  const double filter_steps = c.draft.period_s * c.draft.plant.module.filter_rate_hz;
  const double ratio = std::max(filter_steps, 1.0 / filter_steps);
  constexpr double kTolerance = 1e-7;
  if (std::abs(ratio - std::round(ratio)) > kTolerance) {
    c.fail("period_s", fmt::format("{} s does not fit the tactile module", c.draft.period_s),
           fmt::format("a multiple or a whole part of its filter period of {} s",
                       1.0 / c.draft.plant.module.filter_rate_hz));
  }
  // A sample that is not new is a period old at once.
  if (c.draft.module.max_sample_age_s < c.draft.period_s) {
    const std::string key = "tactile_module.max_sample_age_s";
    failAt(locate(c.robot.root, key), key,
           fmt::format("{} s is shorter than a cycle", c.draft.module.max_sample_age_s),
           fmt::format("expected at least the scene's period_s = {}", c.draft.period_s));
  }
}

void checkGains(const Checked& c) {
  const bool is_joint_space = c.draft.variant == "joint_space";
  const auto problem = findGainConflict(c.draft.gains, is_joint_space, c.draft.period_s);
  if (problem) c.fail(problem->path, problem->problem, problem->expectation);
}

void checkObstacles(const Checked& c) {
  for (std::size_t i = 0; i < c.draft.plant.obstacles.size(); ++i) {
    const ObstacleConfig& obstacle = c.draft.plant.obstacles[i];
    const std::string path = fmt::format("simulation.obstacles[{}]", i);
    if (obstacle.vanishes_s <= obstacle.appears_s) {
      c.fail(path + ".vanishes_s", fmt::format("{} s is too early", obstacle.vanishes_s),
             fmt::format("more than appears_s = {}", obstacle.appears_s));
    }
    for (std::size_t k = 1; k < obstacle.foam.size(); ++k) {
      if (obstacle.foam[k].until_force_N > obstacle.foam[k - 1].until_force_N) continue;
      c.fail(fmt::format("{}.foam[{}].until_force_N", path, k),
             fmt::format("{} N is not above the layer before", obstacle.foam[k].until_force_N),
             fmt::format("more than {} N", obstacle.foam[k - 1].until_force_N));
    }
  }
}

}  // namespace

void checkScene(const YamlNode& root, const ConfigDraft& draft, const LoadedRobot& robot,
                const JointVector& q_start) {
  const Checked checked{root, draft, robot, q_start};
  checkTask(checked);
  checkTrajectory(checked);
  checkController(checked);
  checkDuration(checked);
  checkPeriod(checked);
  checkSimulatedModule(checked);
  checkGains(checked);
  checkObstacles(checked);
}

}  // namespace tactus
