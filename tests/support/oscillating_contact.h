#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/crops9.h"
#include "support/shipped_scene.h"
#include "tactus/analysis/stability_margins.h"
#include "tactus/control/controller.h"

/// A small oscillation about a rest in contact: whether it calms down in closed loop, and above
/// which stiffness it no longer does. What the margins of a contact loop are judged by.
namespace tactus::test {

inline constexpr double kC_N_per_m = 7000.0;
inline constexpr double kRest_N = 2.0;  ///< force about which all oscillates
inline constexpr double kKick = 0.01;   ///< of it, at the start
inline constexpr double kRadius_m = 0.06;
inline constexpr double kSettling_s = 0.48;  ///< of the sensor, at rest

/// The loop as a controller meets it.
struct LoopCase {
  const char* name;
  ContactLoop loop;
  Variant variant = Variant::kNullSpace;
  bool is_fed_forward = false;  ///< the motion of the task is taken out of the contact

  bool isTwoSpaces() const { return loop.law == LoopLaw::kTwoSpaces; }
  double P() const {
    const double gain = loop.order == 2 ? 2.0 * loop.damping : 1.0;
    return gain / (loop.time_constant_s * kC_N_per_m);
  }
  double I() const { return 1.0 / (loop.time_constant_s * loop.time_constant_s * kC_N_per_m); }
};

inline void PrintTo(const LoopCase& c, std::ostream* stream) { *stream << c.name; }

inline void setForceControl(const LoopCase& c, ControllerConfig& config) {
  config.force_control = {
      .variant = c.variant,
      .level = c.loop.is_acceleration ? ControlLevel::kAcceleration : ControlLevel::kVelocity,
      .order = c.loop.is_acceleration ? 2 : c.loop.order};
  ForceGains& gains = config.gains.force;
  gains = {};
  gains.time_constant_s = c.loop.time_constant_s;
  gains.damping = c.loop.damping;
  if (c.loop.answer_lag_s > 0.0) gains.velocity_gain_per_s = 1.0 / c.loop.answer_lag_s;
  gains.contact_threshold_N = 0.0;
  gains.max_null_speed_m_per_s = 1e6;
  gains.assumed_stiffness_N_per_m = kC_N_per_m;
  if (c.variant == Variant::kNullLimit) gains.max_null_speed_m_per_s = 1e-12;  // the task alone
  if (!c.is_fed_forward) gains.transition.engage_force_N = 1e12;  // gamma stays at zero
}

inline PlantConfig plantAt(double x_m, double y_m, double stiffness_N_per_m,
                           const ContactLoop& loop) {
  PlantConfig plant = test::crops9Plant({test::band(x_m, y_m, stiffness_N_per_m)});
  plant.robot_stiffness_N_per_m = kNoLimit;
  plant.modules[0].cover_radius_m = kRadius_m;
  plant.drive_lag_s = loop.drive_lag_s;
  plant.modules[0].filter_cutoff_hz = loop.filter_cutoff_hz;
  plant.modules[0].filter_rate_hz = loop.filter_rate_hz;
  plant.modules[0].channels.sample_period_s = loop.sample_period_s;
  return plant;
}

struct Range {
  double low = kNoLimit, high = -kNoLimit;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double width() const { return high - low; }
};

/// Runs from a settled sensor. Is the oscillation after 3 t_s smaller than after t_s, or gone?
template <typename SomeRobot>
bool calmsDown(const Controller& controller, SomeRobot& robot, ControllerState state,
               double period_s, double t_s) {
  const JointVector at_rest = JointVector::Zero(state.q_desired.size());
  const long settling =
      std::lround(kSettling_s / period_s);  // a multiple of the sample period, too
  for (long i = 0; i < settling; ++i) robot.write(at_rest);
  RobotInput input;
  ControllerOutput output;
  Range early, late;
  const int start = static_cast<int>(t_s / period_s);
  const int window = start / 3;
  for (int cycle = 0; cycle < 3 * start; ++cycle) {
    robot.read(input);
    controller.update(input, controller.initialGains(), cycle * period_s, period_s, state, output);
    if (output.fault != Fault::kNone) return false;  // a force beyond the sensor's range
    robot.write(output.velocity);
    if (cycle >= start && cycle < start + window) early.add(robot.trueForce_N());
    if (cycle >= 3 * start - window) late.add(robot.trueForce_N());
  }
  const bool stays_in_contact = std::min(early.low, late.low) > 0.1;
  const double smaller_N = std::max(early.width(), 0.1 * kKick * late.high);
  return stays_in_contact && late.width() < smaller_N;
}

/// The nine-joint arm in the pose of the paper's scenes, with all it has of geometry; both spaces,
/// the motion of the task fed forward. The elbow is pushed away from the path.
inline ControllerConfig armController(const LoopCase& c) {
  ControllerConfig config = test::crops9Controller(c.variant);
  config.has_joint_limit_avoidance = false;
  config.task.trajectory = {};
  config.gains.task.drift_gain_per_s = 5.0;
  setForceControl(c, config);
  config.gains.force.activation_force_N = 1.0;
  return config;
}

struct Side {
  Vector3 p_BaseContact, normal;  ///< the middle of the cover's axis, and out of the cover
};

inline Side sideOf(const ControllerConfig& config) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  const Pose X_BaseModule = framePose(pose, config.tactile_modules.front().link);
  const Vector3 axis = X_BaseModule.R_AB.col(0);
  return {X_BaseModule.p_AB + 0.5 * config.tactile_modules.front().length_m * axis,
          Vector3(-axis.y(), axis.x(), 0.0).normalized()};
}

/// Of gears that sag under the force, m/N.
inline double gearCompliance(const LoopCase& c) {
  if (!c.loop.geared) return 0.0;
  const JointVector& a = c.loop.geared->a;
  return a.dot(a.cwiseQuotient(c.loop.geared->arm.gear_stiffness));
}

/// For minutes at this speed; what a first-order law follows, pressed by a constant force.
inline void pushAt(double speed_m_per_s, const Vector3& direction, ObstacleConfig& obstacle) {
  constexpr double kSwing_hz = 1e-3;
  const Vector3 way = speed_m_per_s / (2.0 * std::numbers::pi * kSwing_hz) * direction;
  obstacle.swing = {way.x(), way.y(), kSwing_hz};
}

/// SomeRobot: of controller, plant and period.
template <typename SomeRobot>
bool calmsDownOnArm(const LoopCase& c, double stiffness_ratio) {
  ControllerConfig config = armController(c);
  const double rest_N = 0.5 * config.gains.force.activation_force_N;
  const Side side = sideOf(config);
  const double depth_m =
      (1.0 + kKick) * rest_N * (1.0 / (stiffness_ratio * kC_N_per_m) + gearCompliance(c));
  const double push_m_per_s = c.isTwoSpaces() ? 0.0 : c.P() * rest_N;
  const Vector3 p_Base =
      side.p_BaseContact + (kRadius_m - depth_m + kSettling_s * push_m_per_s) * side.normal;

  const Controller controller(config);
  ControllerState state = controller.initialState();
  if (c.isTwoSpaces()) state.contact.law = {-0.03, 0.03, {}};
  PlantConfig plant = plantAt(p_Base.x(), p_Base.y(), stiffness_ratio * kC_N_per_m, c.loop);
  if (c.loop.geared) plant.dynamics = c.loop.geared->arm;
  pushAt(push_m_per_s, -side.normal, plant.obstacles.front());
  SomeRobot robot(config, plant, c.loop.period_s);
  return calmsDown(controller, robot, state, c.loop.period_s, 8.0 * c.loop.time_constant_s);
}

/// With the masses and gears of the arm that is shipped.
inline LoopCase geared(LoopCase c) {
  const ControllerConfig config = armController(c);
  const Scene scene =
      test::shippedScene("scenario1_null_space", {{"simulation.arm", "flexible_gears"}});
  c.loop.geared = gearedContact(config, *scene.plant.dynamics, config.q_start,
                                sideOf(config).normal, AnswerSpace::kNull);
  c.loop.geared->law_N_per_m = kC_N_per_m;
  return c;
}

template <typename CalmsDown>
double bisectRatio(CalmsDown calms_down, double resolution = 1.001) {
  double stable = 0.1, unstable = 100.0;
  EXPECT_TRUE(calms_down(stable));
  EXPECT_FALSE(calms_down(unstable));
  while (unstable / stable > resolution) {
    const double middle = std::sqrt(stable * unstable);
    (calms_down(middle) ? stable : unstable) = middle;
  }
  return stable;
}

}  // namespace tactus::test
