#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/crops9.h"
#include "support/rail_robot.h"
#include "support/shipped_scene.h"
#include "tactus/analysis/stability_margins.h"
#include "tactus/sim/simulated_robot.h"

/// The margins against what controller and simulated robot do: the stiffness above which a small
/// oscillation grows, found by bisection.
namespace tactus {
namespace {

constexpr double kC_N_per_m = 7000.0;
constexpr double kRest_N = 2.0;  ///< force about which all oscillates
constexpr double kKick = 0.01;   ///< of it, at the start
constexpr double kRadius_m = 0.06;
constexpr double kSettling_s = 0.48;  ///< of the sensor, at rest

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

void PrintTo(const LoopCase& c, std::ostream* stream) { *stream << c.name; }

void setForceControl(const LoopCase& c, ControllerConfig& config) {
  config.force_control = {.variant = c.variant, .order = c.loop.order};
  ForceGains& gains = config.gains.force;
  gains = {};
  gains.time_constant_s = c.loop.time_constant_s;
  gains.damping = c.loop.damping;
  gains.contact_threshold_N = 0.0;
  gains.max_null_speed_m_per_s = 1e6;
  gains.assumed_stiffness_N_per_m = kC_N_per_m;
  if (c.variant == Variant::kNullLimit) gains.max_null_speed_m_per_s = 1e-12;  // the task alone
  if (!c.is_fed_forward) gains.transition.engage_force_N = 1e12;  // gamma stays at zero
}

PlantConfig plantAt(double x_m, double y_m, double stiffness_N_per_m, const ContactLoop& loop) {
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
bool calmsDown(const Controller& controller, SimulatedRobot& robot, ControllerState state,
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

/// What keeps the rail robot's law at kRest_N instead of zero: a task that carries the contact
/// towards the obstacle. Speeds and lengths are those of the contact, half of those of the tool.
struct Rest {
  double speed_m_per_s = 0.0;  ///< at the start
  double acceleration_m_per_s2 = 0.0;
  double It_m_per_s = 0.0;
  double V_m_per_s = 0.0;
  double off_path_m = 0.0;  ///< where the pull of beta balances It
  double activation_N = 0.0;
};

Rest restOf(const LoopCase& c) {
  const double beta = c.loop.drift_gain_per_s;
  // Both integrals move, but their sum rests at half the activation force.
  if (c.is_fed_forward) return {.It_m_per_s = 0.5, .V_m_per_s = -0.5, .activation_N = 2 * kRest_N};
  if (c.variant == Variant::kNullLimit) return {.speed_m_per_s = 0.02, .activation_N = kRest_N};
  if (c.loop.order == 1) return {.speed_m_per_s = (c.isTwoSpaces() ? 2 : 1) * c.P() * kRest_N};
  Rest rest;
  if (c.variant == Variant::kTaskSpace && beta > 0.0) {
    rest.speed_m_per_s = c.I() * kRest_N / beta;  // the tool falls behind, and V follows
  } else {
    rest.acceleration_m_per_s2 = c.I() * kRest_N;
    rest.speed_m_per_s = rest.acceleration_m_per_s2 * 1000.0 / std::numbers::pi;
  }
  rest.V_m_per_s = rest.speed_m_per_s - c.P() * kRest_N;
  if (!c.isTwoSpaces()) return rest;
  rest.activation_N = kRest_N;
  rest.It_m_per_s = 0.01;
  if (beta > 0.0) {
    rest.off_path_m = rest.It_m_per_s / beta;
  } else {
    rest.V_m_per_s -= rest.It_m_per_s;
  }
  return rest;
}

TrajectoryConfig trajectoryOf(const Rest& rest) {
  if (rest.speed_m_per_s == 0.0) return {};
  Waypoint line;
  line.displacement_m = Vector3(0.0, 1e6, 0.0);
  line.speed_m_per_s = 2.0 * rest.speed_m_per_s;
  if (rest.acceleration_m_per_s2 == 0.0) return {-1.0, {line}};
  line.ramp_s = 1000.0;  // halfway it speeds up as evenly as can be
  line.speed_m_per_s *= 2.0;
  return {-0.5 * line.ramp_s, {line}};
}

bool calmsDownOnRail(const LoopCase& c, double stiffness_ratio) {
  const Rest rest = restOf(c);
  ControllerConfig config = test::railController(c.variant);
  setForceControl(c, config);
  config.gains.force.activation_force_N = rest.activation_N;
  config.tactile_modules.front().max_sample_age_s = 1.0;
  config.tactile_modules.front().filter_cutoff_hz = c.loop.model_filter_cutoff_hz;
  config.drive_lag_s = c.loop.model_drive_lag_s;
  config.gains.task.drift_gain_per_s = c.is_fed_forward ? 20.0 : c.loop.drift_gain_per_s;
  config.task.trajectory = trajectoryOf(rest);
  const Controller controller(config);

  const double tool_m =
      Trajectory(config.task.trajectory, {}).evaluate(0.0).p_BaseTool.y() - 2.0 * rest.off_path_m;
  const double contact_m = (1.0 + kKick) * kRest_N / (stiffness_ratio * kC_N_per_m);
  config.q_start << contact_m, tool_m - contact_m;
  ControllerState state = controller.initialState(config.q_start);
  state.contact.law = {rest.V_m_per_s, rest.It_m_per_s, {}};
  SimulatedRobot robot(config, plantAt(0.5, kRadius_m, stiffness_ratio * kC_N_per_m, c.loop),
                       c.loop.period_s);
  return calmsDown(controller, robot, state, c.loop.period_s, 20.0 * c.loop.time_constant_s);
}

/// The nine-joint arm in the pose of the paper's scenes, with all it has of geometry; both spaces,
/// the motion of the task fed forward. The elbow is pushed away from the path.
ControllerConfig armController(const LoopCase& c) {
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

Side sideOf(const ControllerConfig& config) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  const Pose X_BaseModule = framePose(pose, config.tactile_modules.front().link);
  const Vector3 axis = X_BaseModule.R_AB.col(0);
  return {X_BaseModule.p_AB + 0.5 * config.tactile_modules.front().length_m * axis,
          Vector3(-axis.y(), axis.x(), 0.0).normalized()};
}

/// Of gears that sag under the force, m/N.
double gearCompliance(const LoopCase& c) {
  if (!c.loop.geared) return 0.0;
  const JointVector& a = c.loop.geared->a;
  return a.dot(a.cwiseQuotient(c.loop.geared->arm.gear_stiffness));
}

/// For minutes at this speed; what a first-order law follows, pressed by a constant force.
void pushAt(double speed_m_per_s, const Vector3& direction, ObstacleConfig& obstacle) {
  constexpr double kSwing_hz = 1e-3;
  const Vector3 way = speed_m_per_s / (2.0 * std::numbers::pi * kSwing_hz) * direction;
  obstacle.swing = {way.x(), way.y(), kSwing_hz};
}

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
  SimulatedRobot robot(config, plant, c.loop.period_s);
  return calmsDown(controller, robot, state, c.loop.period_s, 8.0 * c.loop.time_constant_s);
}

/// With the masses and gears of the arm that is shipped.
LoopCase geared(LoopCase c) {
  const ControllerConfig config = armController(c);
  const Scene scene =
      test::shippedScene("scenario1_null_space", {{"simulation.arm", "flexible_gears"}});
  c.loop.geared = gearedContact(config, *scene.plant.dynamics, config.q_start,
                                sideOf(config).normal, AnswerSpace::kNull);
  c.loop.geared->law_N_per_m = kC_N_per_m;
  return c;
}

template <typename CalmsDown>
double bisectRatio(CalmsDown calms_down) {
  double stable = 0.1, unstable = 100.0;
  EXPECT_TRUE(calms_down(stable));
  EXPECT_FALSE(calms_down(unstable));
  while (unstable / stable > 1.001) {
    const double middle = std::sqrt(stable * unstable);
    (calms_down(middle) ? stable : unstable) = middle;
  }
  return stable;
}

void expectAgreement(const LoopCase& c, bool (*calms_down)(const LoopCase&, double),
                     double tolerance) {
  const double computed = computeMargins(c.loop, 1.0).largest_stiffness_ratio;
  const double simulated = bisectRatio([&](double ratio) { return calms_down(c, ratio); });
  testing::Test::RecordProperty("computed", std::to_string(computed));
  testing::Test::RecordProperty("simulated", std::to_string(simulated));
  EXPECT_NEAR(simulated, computed, tolerance * computed);
}

class SimulatedContact : public testing::TestWithParam<LoopCase> {};

TEST_P(SimulatedContact, BecomesUnstableWhereTheMarginsSay) {
  expectAgreement(GetParam(), calmsDownOnRail, 0.001);
}

constexpr auto kOne = LoopLaw::kOneSpace;
constexpr auto kTwo = LoopLaw::kTwoSpaces;
constexpr auto kTask = Variant::kTaskSpace;
constexpr auto kNullTask = Variant::kNullTask;
constexpr auto kNullJoint = Variant::kNullJoint;
constexpr auto kNullLimit = Variant::kNullLimit;
const auto kName = [](const auto& test) { return test.param.name; };

INSTANTIATE_TEST_SUITE_P(OneSpace, SimulatedContact,
                         testing::Values(LoopCase{"paper", {}}, LoopCase{"task", {}, kTask},
                                         LoopCase{"ideal_drives", {.drive_lag_s = 0.0}},
                                         LoopCase{"slow_drives", {.drive_lag_s = 0.01}},
                                         LoopCase{"T_50_ms", {.time_constant_s = 0.05}},
                                         LoopCase{"T_200_ms", {.time_constant_s = 0.2}},
                                         LoopCase{"d_1", {.damping = 1.0}},
                                         LoopCase{"first_order", {.order = 1}},
                                         LoopCase{"beta_20", {.drift_gain_per_s = 20.0}, kTask}),
                         kName);

INSTANTIATE_TEST_SUITE_P(
    TwoSpaces, SimulatedContact,
    testing::Values(LoopCase{"paper", {.law = kTwo}, kNullTask},
                    LoopCase{"joint", {.law = kTwo}, kNullJoint},
                    LoopCase{"first_order", {.law = kTwo, .order = 1}, kNullTask},
                    LoopCase{"d_1", {.law = kTwo, .damping = 1.0}, kNullTask},
                    LoopCase{"T_200_ms", {.law = kTwo, .time_constant_s = 0.2}, kNullTask},
                    LoopCase{"beta_5", {.law = kTwo, .drift_gain_per_s = 5.0}, kNullTask},
                    LoopCase{"beta_20", {.law = kTwo, .drift_gain_per_s = 20.0}, kNullTask},
                    LoopCase{"beta_20_fed_forward", {.law = kTwo}, kNullTask, true}),
    kName);

/// With a right model, unless it is given.
ContactLoop limitLoop(ContactLoop loop = {}) {
  loop.law = LoopLaw::kApproachLimit;
  loop.order = 1;
  return loop;
}

ContactLoop modelled(ContactLoop loop, double drive_lag_s, double filter_cutoff_hz) {
  loop.model_drive_lag_s = drive_lag_s;
  loop.model_filter_cutoff_hz = filter_cutoff_hz;
  return loop;
}

INSTANTIATE_TEST_SUITE_P(
    ApproachLimit, SimulatedContact,
    testing::Values(
        LoopCase{"T_100_ms", limitLoop(), kNullLimit},
        LoopCase{"T_50_ms", limitLoop({.time_constant_s = 0.05}), kNullLimit},
        LoopCase{"T_200_ms", limitLoop({.time_constant_s = 0.2}), kNullLimit},
        LoopCase{"slow_samples", limitLoop({.sample_period_s = 0.02}), kNullLimit},
        LoopCase{"odd_cycle", limitLoop({.period_s = 0.003}), kNullLimit},
        LoopCase{"slow_cycle", limitLoop({.period_s = 0.008}), kNullLimit},
        LoopCase{"ideal_drives", modelled(limitLoop({.drive_lag_s = 0.0}), 0.0, 15.0), kNullLimit},
        LoopCase{"slow_drives", modelled(limitLoop({.drive_lag_s = 0.01}), 0.01, 15.0), kNullLimit},
        LoopCase{"drives_slower_than_thought", limitLoop({.drive_lag_s = 0.02}), kNullLimit},
        LoopCase{"filter_slower_than_thought", limitLoop({.filter_cutoff_hz = 5.0}), kNullLimit},
        LoopCase{"filter_faster_than_thought", limitLoop({.filter_cutoff_hz = 30.0}), kNullLimit}),
    kName);

INSTANTIATE_TEST_SUITE_P(Rates, SimulatedContact,
                         testing::Values(LoopCase{"fast_cycle", {.period_s = 0.00025}},
                                         LoopCase{"slow_cycle", {.period_s = 0.004}},
                                         LoopCase{"odd_cycle", {.period_s = 0.003}},
                                         LoopCase{"slow_samples", {.sample_period_s = 0.02}},
                                         LoopCase{"fast_filter", {.filter_cutoff_hz = 60.0}}),
                         kName);

TEST(SimulatedArm, BecomesUnstableWhereTheMarginsSay) {
  expectAgreement({"both", {.law = kTwo}, kNullTask, true}, calmsDownOnArm, 0.05);
}

TEST(SimulatedArm, BecomesUnstableWhereTheMarginsSayWithMoreDamping) {
  expectAgreement({"d_1", {.law = kTwo, .damping = 1.0}, kNullTask, true}, calmsDownOnArm, 0.05);
}

TEST(SimulatedArm, WithMassesAndGearsBecomesUnstableWhereTheMarginsSay) {
  const LoopCase null_space{"null", {.order = 1}, Variant::kNullSpace};
  const double rigid = computeMargins(null_space.loop, 1.0).largest_stiffness_ratio;
  const LoopCase flexible = geared(null_space);
  expectAgreement(flexible, calmsDownOnArm, 0.05);
  EXPECT_LT(computeMargins(flexible.loop, 1.0).largest_stiffness_ratio, 0.6 * rigid);
}

TEST(SimulatedArm, WithMassesAndGearsAndOtherTimesBecomesUnstableWhereTheMarginsSay) {
  for (const double T_s : {0.05, 0.2}) {
    const ContactLoop loop{.order = 1, .time_constant_s = T_s};
    expectAgreement(geared({"T", loop, Variant::kNullSpace}), calmsDownOnArm, 0.05);
  }
}

}  // namespace
}  // namespace tactus
