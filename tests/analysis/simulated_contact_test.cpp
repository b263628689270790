#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/oscillating_contact.h"
#include "support/rail_robot.h"
#include "tactus/sim/simulated_robot.h"

/// The margins against what controller and simulated robot do: the stiffness above which a small
/// oscillation grows, found by bisection.
namespace tactus {
namespace {

using test::kC_N_per_m;
using test::kKick;
using test::kRadius_m;
using test::kRest_N;
using test::LoopCase;

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
  test::setForceControl(c, config);
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
  // At the acceleration level the command is the memory: the contact rests while the tool moves.
  const double pushed_m_per_s = c.loop.drift_gain_per_s > 0.0 ? 0.0 : rest.It_m_per_s;
  if (c.loop.is_acceleration && c.variant != Variant::kNullLimit)
    state.velocity_before[1] = 2.0 * (rest.speed_m_per_s - pushed_m_per_s);
  SimulatedRobot robot(config, test::plantAt(0.5, kRadius_m, stiffness_ratio * kC_N_per_m, c.loop),
                       c.loop.period_s);
  return test::calmsDown(controller, robot, state, c.loop.period_s, 20.0 * c.loop.time_constant_s);
}

void expectAgreement(const LoopCase& c, bool (*calms_down)(const LoopCase&, double),
                     double tolerance) {
  const double computed = computeMargins(c.loop, 1.0).largest_stiffness_ratio;
  const double simulated = test::bisectRatio([&](double ratio) { return calms_down(c, ratio); });
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

ContactLoop accelerationLoop(ContactLoop loop = {}) {
  loop.is_acceleration = true;
  return loop;
}

INSTANTIATE_TEST_SUITE_P(
    AccelerationLevel, SimulatedContact,
    testing::Values(LoopCase{"one", accelerationLoop()},
                    LoopCase{"one_ideal_drives", accelerationLoop({.drive_lag_s = 0.0})},
                    LoopCase{"one_T_50_ms", accelerationLoop({.time_constant_s = 0.05})},
                    LoopCase{"one_d_1", accelerationLoop({.damping = 1.0})},
                    LoopCase{"one_odd_cycle", accelerationLoop({.period_s = 0.003})},
                    LoopCase{"one_slow_samples", accelerationLoop({.sample_period_s = 0.02})},
                    LoopCase{"two", accelerationLoop({.law = kTwo}), kNullTask},
                    LoopCase{"two_slow_drives",
                             accelerationLoop({.law = kTwo, .drive_lag_s = 0.01}), kNullTask},
                    LoopCase{"two_d_1", accelerationLoop({.law = kTwo, .damping = 1.0}), kNullTask},
                    LoopCase{"two_beta_5", accelerationLoop({.law = kTwo, .drift_gain_per_s = 5.0}),
                             kNullTask},
                    LoopCase{"two_beta_20",
                             accelerationLoop({.law = kTwo, .drift_gain_per_s = 20.0}), kNullTask}),
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

ContactLoop easedLimitLoop(double k_v_per_s, ContactLoop loop = {}) {
  loop.answer_lag_s = 1.0 / k_v_per_s;
  return limitLoop(accelerationLoop(loop));
}

INSTANTIATE_TEST_SUITE_P(
    EasedApproachLimit, SimulatedContact,
    testing::Values(
        LoopCase{"k_v_200", easedLimitLoop(200.0), kNullLimit},
        LoopCase{"k_v_50", easedLimitLoop(50.0), kNullLimit},
        LoopCase{"T_50_ms", easedLimitLoop(200.0, {.time_constant_s = 0.05}), kNullLimit},
        LoopCase{"odd_cycle", easedLimitLoop(200.0, {.period_s = 0.003}), kNullLimit},
        LoopCase{"slow_drives", easedLimitLoop(200.0, {.drive_lag_s = 0.02}), kNullLimit}),
    kName);

INSTANTIATE_TEST_SUITE_P(Rates, SimulatedContact,
                         testing::Values(LoopCase{"fast_cycle", {.period_s = 0.00025}},
                                         LoopCase{"slow_cycle", {.period_s = 0.004}},
                                         LoopCase{"odd_cycle", {.period_s = 0.003}},
                                         LoopCase{"slow_samples", {.sample_period_s = 0.02}},
                                         LoopCase{"fast_filter", {.filter_cutoff_hz = 60.0}}),
                         kName);

TEST(SimulatedArm, BecomesUnstableWhereTheMarginsSay) {
  expectAgreement({"both", {.law = kTwo}, kNullTask, true}, test::calmsDownOnArm<SimulatedRobot>,
                  0.05);
}

TEST(SimulatedArm, BecomesUnstableWhereTheMarginsSayWithMoreDamping) {
  expectAgreement({"d_1", {.law = kTwo, .damping = 1.0}, kNullTask, true},
                  test::calmsDownOnArm<SimulatedRobot>, 0.05);
}

TEST(SimulatedArm, WithMassesAndGearsBecomesUnstableWhereTheMarginsSay) {
  const LoopCase null_space{"null", {.order = 1}, Variant::kNullSpace};
  const double rigid = computeMargins(null_space.loop, 1.0).largest_stiffness_ratio;
  const LoopCase flexible = test::geared(null_space);
  expectAgreement(flexible, test::calmsDownOnArm<SimulatedRobot>, 0.05);
  EXPECT_LT(computeMargins(flexible.loop, 1.0).largest_stiffness_ratio, 0.6 * rigid);
}

TEST(SimulatedArm, WithMassesAndGearsAndOtherTimesBecomesUnstableWhereTheMarginsSay) {
  for (const double T_s : {0.05, 0.2}) {
    const ContactLoop loop{.order = 1, .time_constant_s = T_s};
    expectAgreement(test::geared({"T", loop, Variant::kNullSpace}),
                    test::calmsDownOnArm<SimulatedRobot>, 0.05);
  }
}

}  // namespace
}  // namespace tactus
