#include "tactus/analysis/contact_peak.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/crops9.h"
#include "support/rail_robot.h"
#include "support/random.h"
#include "tactus/sim/simulated_robot.h"

/// The force that is expected of a first touch against what controller and simulated robot do, over
/// gains, speeds, filters and stiffnesses by chance.
namespace tactus {
namespace {

using test::Random;

constexpr double kTouchedRadius_m = 0.06;

/// What a touch is made of.
struct TouchCase {
  ContactLoop loop;
  Variant variant = Variant::kNullSpace;
  double threshold_N = 1.2;
  double assumed_N_per_m = 7000.0;
  double speed_m_per_s = 0.1;
  double phase = 0.0;  ///< of the touch between two samples
  ObstacleConfig obstacle = test::band(0.5, kTouchedRadius_m, 7000.0);

  TouchedSpring touched() const { return {loop, threshold_N, ContactSpring(obstacle, kNoLimit)}; }
};

ControllerConfig controllerOf(const TouchCase& c) {
  ControllerConfig config = test::railController(c.variant);
  config.force_control->order = c.loop.order;
  config.tactile_modules.front().max_force_N = 1e9;
  config.tactile_modules.front().filter_cutoff_hz = c.loop.filter_cutoff_hz;
  config.drive_lag_s = c.loop.drive_lag_s;
  config.gains.task.drift_gain_per_s = 5.0;
  ForceGains& gains = config.gains.force;
  gains.time_constant_s = c.loop.time_constant_s;
  gains.damping = c.loop.damping;
  gains.contact_threshold_N = c.threshold_N;
  gains.assumed_stiffness_N_per_m = c.assumed_N_per_m;
  Waypoint line;  // the contact moves half as fast as the tool
  line.displacement_m = Vector3(0.0, 1e3, 0.0);
  line.speed_m_per_s = 2.0 * c.speed_m_per_s;
  line.ramp_s = 1e-3;
  config.task.trajectory = {-1.0, {line}};
  return config;
}

/// The largest force until a little after the expected end of the touch.
double simulatedPeak(const TouchCase& c) {
  ControllerConfig config = controllerOf(c);
  const Controller controller(config);  // whose path starts at zero
  const double v = c.speed_m_per_s;
  const double tool_m = Trajectory(config.task.trajectory, {}).evaluate(0.0).p_BaseTool.y();
  const double run_up_s = 0.2 + c.phase * c.loop.sample_period_s;
  config.q_start << -v * run_up_s, tool_m + v * run_up_s;
  PlantConfig plant = test::crops9Plant({c.obstacle});
  plant.robot_stiffness_N_per_m = kNoLimit;
  plant.modules[0].cover_radius_m = kTouchedRadius_m;
  plant.drive_lag_s = c.loop.drive_lag_s;
  plant.modules[0].filter_cutoff_hz = c.loop.filter_cutoff_hz;
  plant.modules[0].filter_rate_hz = c.loop.filter_rate_hz;
  plant.modules[0].channels.sample_period_s = c.loop.sample_period_s;
  ControllerState state = controller.initialState(config.q_start);
  SimulatedRobot robot(config, plant, c.loop.period_s);
  RobotInput input;
  ControllerOutput output;
  double peak_N = 0.0;
  const double end_s = run_up_s + c.loop.drive_lag_s + 2.0 * touchDelay_s(c.touched(), v) + 0.05;
  for (double t_s = 0.0; t_s < end_s; t_s += c.loop.period_s) {
    robot.read(input);
    controller.update(input, config.gains, t_s, c.loop.period_s, state, output);
    robot.write(output.velocity);
    peak_N = std::max(peak_N, robot.trueForce_N());
  }
  EXPECT_GT(peak_N, c.threshold_N);
  return peak_N;
}

constexpr Variant kVariants[] = {Variant::kNullSpace, Variant::kTaskSpace, Variant::kNullTask,
                                 Variant::kNullLimit};

TouchCase randomCase(Random& random) {
  TouchCase c;
  c.variant = kVariants[random.index(4)];
  c.loop.order = random.chance(0.5) ? 1 : 2;
  c.loop.time_constant_s = random.uniform(0.08, 0.4);
  c.loop.damping = random.uniform(0.4, 1.0);
  c.loop.drive_lag_s = random.uniform(0.0, 0.015);
  c.loop.filter_cutoff_hz = random.logUniform(8.0, 100.0);
  c.loop.sample_period_s = 0.001 * (1 + random.index(8));
  c.threshold_N = random.uniform(0.3, 2.0);
  c.speed_m_per_s = random.logUniform(0.01, 0.4);
  c.obstacle.stiffness_N_per_m = random.logUniform(500.0, 2e4);
  if (random.chance(0.3))
    c.obstacle.foam = {{random.logUniform(300.0, 3e3), random.uniform(1.0, 20.0)}};
  c.assumed_N_per_m = c.obstacle.stiffness_N_per_m * random.uniform(1.0, 2.0);
  c.phase = random.uniform(0.0, 1.0);
  return c;
}

/// What spreads is the age of the sample: the touch comes at any time between two.
TEST(ContactPeak, IsWhatSimulationsComeTo) {
  Random random(171);
  constexpr int kCases = 400;
  std::vector<double> ratios;
  for (int i = 0; i < kCases; ++i) {
    const TouchCase c = randomCase(random);
    ratios.push_back(simulatedPeak(c) / touchPeak_N(c.touched(), c.speed_m_per_s));
  }
  std::ranges::sort(ratios);
  EXPECT_GT(ratios.front(), 0.45);
  EXPECT_LT(ratios.back(), 1.5);
  EXPECT_GT(ratios[kCases / 20], 0.8);
  EXPECT_LT(ratios[kCases - kCases / 20], 1.12);
  EXPECT_NEAR(ratios[kCases / 2], 0.96, 0.04);
}

/// The same touch with 24 sets of gains.
TEST(ContactPeak, IsTheSameForAllGains) {
  Random random(172);
  TouchCase c;
  const double expected_N = touchPeak_N(c.touched(), c.speed_m_per_s);
  EXPECT_NEAR(expected_N, c.speed_m_per_s * 7000.0 * touchDelay_s(c.touched(), c.speed_m_per_s),
              1e-9 * expected_N);
  for (int i = 0; i < 24; ++i) {
    c.variant = kVariants[random.index(4)];
    c.loop.order = 1 + random.index(2);
    c.loop.time_constant_s = random.uniform(0.08, 0.4);
    c.loop.damping = random.uniform(0.4, 1.0);
    c.assumed_N_per_m = random.uniform(7000.0, 14000.0);
    EXPECT_NEAR(simulatedPeak(c), expected_N, 0.15 * expected_N);
  }
}

TEST(ContactPeak, ComesOfDelayAndSpeedInEachSpring) {
  Random random(173);
  int with_cutoff = 0;
  for (int i = 0; i < 100; ++i) {
    const TouchCase c = randomCase(random);
    const TouchedSpring touched = c.touched();
    const double peak_N = touchPeak_N(touched, c.speed_m_per_s);
    EXPECT_GT(touchPeak_N(touched, 1.3 * c.speed_m_per_s), peak_N);
    const double target_N = c.threshold_N + random.uniform(0.2, 0.9) * (peak_N - c.threshold_N);
    const double slower = touchSpeed_m_per_s(touched, target_N);
    EXPECT_LT(slower, c.speed_m_per_s);
    EXPECT_LE(touchPeak_N(touched, slower), target_N);
    EXPECT_GT(touchPeak_N(touched, 1.01 * slower), 0.98 * target_N);
    const std::optional<double> cutoff_hz = touchCutoff_hz(touched, c.speed_m_per_s, target_N);
    if (!cutoff_hz) continue;
    ++with_cutoff;
    TouchedSpring faster = touched;
    faster.loop.filter_cutoff_hz = *cutoff_hz;
    EXPECT_GT(*cutoff_hz, c.loop.filter_cutoff_hz);
    EXPECT_LE(touchPeak_N(faster, c.speed_m_per_s), target_N);
  }
  EXPECT_GT(with_cutoff, 20);
}

TEST(ContactPeak, HasNoSpeedForAForceThatTheLawDoesNotAnswer) {
  TouchCase c;
  EXPECT_EQ(touchSpeed_m_per_s(c.touched(), c.threshold_N), 0.0);
  EXPECT_FALSE(touchCutoff_hz(c.touched(), c.speed_m_per_s, c.threshold_N));
}

/// Slower than any filter: the force is over F_th, and the delays are long past.
TEST(ContactPeak, OfTheSlowestTouchIsTheThreshold) {
  TouchCase c;
  for (const double speed : {1e-9, 1e-7, 1e-5})
    EXPECT_NEAR(touchPeak_N(c.touched(), speed), c.threshold_N, 4e2 * speed + 1e-6);
}

}  // namespace
}  // namespace tactus
