#include "tactus/analysis/predicted_touch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/crops9.h"
#include "support/rail_robot.h"
#include "support/random.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

/// The predicted force against what controller and simulated robot do on a rail, whose Jacobian is
/// constant: what the prediction leaves out is not there, either.
namespace tactus {
namespace {

constexpr double kRail_m = 0.06;     ///< radius of the cover
constexpr double kRunUp_s = 0.48;    ///< a multiple of all periods
constexpr double kFollowed_s = 1.0;  ///< of each touch

struct RailTouch {
  ControllerConfig config;
  PlantConfig plant;
  double period_s = 0.001;
  double speed_m_per_s = 0.1;
  double stiffness_N_per_m = 7000.0;
};

RailTouch railTouch(Variant variant, double speed_m_per_s, double stiffness_N_per_m) {
  RailTouch touch{.config = test::railController(variant),
                  .plant = test::crops9Plant({test::band(0.5, kRail_m, stiffness_N_per_m)}),
                  .speed_m_per_s = speed_m_per_s,
                  .stiffness_N_per_m = stiffness_N_per_m};
  ControllerConfig& config = touch.config;
  config.tactile_modules.front().max_force_N = 1e9;
  config.tactile_modules.front().max_sample_age_s = 1.0;
  config.gains.task.drift_gain_per_s = 5.0;
  config.gains.force.contact_threshold_N = 1.2;
  config.gains.force.assumed_stiffness_N_per_m = stiffness_N_per_m;
  config.gains.force.max_null_speed_m_per_s = 1e6;
  touch.plant.robot_stiffness_N_per_m = kNoLimit;
  touch.plant.modules[0].cover_radius_m = kRail_m;
  return touch;
}

/// F_sen from the touch on, which is halfway between two samples.
std::vector<double> simulatedForces(RailTouch touch) {
  ControllerConfig& config = touch.config;
  const double v = touch.speed_m_per_s;
  Waypoint line;  // the contact moves half as fast as the tool
  line.displacement_m = Vector3(0.0, 1e3, 0.0);
  line.speed_m_per_s = 2.0 * v;
  line.ramp_s = 1e-3;
  config.task.trajectory = {-1.0, {line}};
  const Controller controller(config);
  const double tool_m = Trajectory(config.task.trajectory, {}).evaluate(0.0).p_BaseTool.y();
  const double run_up_s = kRunUp_s + 0.5 * touch.plant.modules[0].channels.sample_period_s;
  config.q_start << -v * (run_up_s - touch.plant.drive_lag_s),
      tool_m + v * (run_up_s - touch.plant.drive_lag_s);
  ControllerState state = controller.initialState(config.q_start);
  SimulatedRobot robot(config, touch.plant, touch.period_s);
  RobotInput input;
  ControllerOutput output;
  std::vector<double> forces;
  for (int i = 0; i * touch.period_s < run_up_s + kFollowed_s; ++i) {
    robot.read(input);
    controller.update(input, config.gains, i * touch.period_s, touch.period_s, state, output);
    robot.write(output.velocity);
    if (i * touch.period_s >= run_up_s - 1e-9) forces.push_back(output.sensed[0].force_N);
  }
  return forces;
}

std::vector<PredictedForce> predictedForces(const RailTouch& touch) {
  std::optional<PredictedTouch> predicted =
      predictedTouch(touch.config, touch.plant, touch.period_s, 0, touch.config.gains);
  EXPECT_TRUE(predicted);
  predicted->stiffness_N_per_m = touch.stiffness_N_per_m;
  predicted->speed_m_per_s = touch.speed_m_per_s;
  return predictForce(*predicted, kFollowed_s);
}

/// The largest difference, as a share of the peak.
double largestForceError(const RailTouch& touch) {
  const std::vector<double> simulated = simulatedForces(touch);
  const std::vector<PredictedForce> predicted = predictedForces(touch);
  EXPECT_NEAR(static_cast<double>(predicted.size()), static_cast<double>(simulated.size()), 1.0);
  double largest_N = 0.0, peak_N = 0.0;
  for (std::size_t i = 0; i < std::min(simulated.size(), predicted.size()); ++i) {
    largest_N = std::max(largest_N, std::abs(simulated[i] - predicted[i].force_N));
    peak_N = std::max(peak_N, simulated[i]);
  }
  EXPECT_GT(peak_N, touch.config.gains.force.contact_threshold_N);
  return largest_N / peak_N;
}

RailTouch randomTouch(test::Random& random, Variant variant) {
  RailTouch touch = railTouch(variant, random.logUniform(0.02, 0.3), random.logUniform(500.0, 2e4));
  ControllerConfig& config = touch.config;
  config.force_control->order = random.chance(0.3) ? 1 : 2;
  ForceGains& gains = config.gains.force;
  gains.time_constant_s = random.uniform(0.1, 0.3);
  gains.damping = random.uniform(0.4, 0.8);
  gains.activation_force_N = random.uniform(1.0, 6.0);
  gains.assumed_stiffness_N_per_m = touch.stiffness_N_per_m * random.uniform(1.0, 2.0);
  config.drive_lag_s = touch.plant.drive_lag_s = 0.001 * random.integer(0, 12);
  config.tactile_modules.front().filter_cutoff_hz = touch.plant.modules[0].filter_cutoff_hz =
      random.logUniform(10.0, 40.0);
  touch.plant.modules[0].channels.sample_period_s = 0.002 * random.integer(1, 4);
  return touch;
}

struct RailCase {
  Variant variant;
  double median, worst;  ///< largest errors that are allowed
};

class PredictedTouchOf : public testing::TestWithParam<RailCase> {};

TEST_P(PredictedTouchOf, IsWhatARailDoes) {
  test::Random random(31);
  std::vector<double> errors;
  for (int i = 0; i < 60; ++i)
    errors.push_back(largestForceError(randomTouch(random, GetParam().variant)));
  std::ranges::sort(errors);
  EXPECT_LT(errors[30], GetParam().median);
  EXPECT_LT(errors.back(), GetParam().worst);
}

/// Bounces included. What all joints do to the tool is not what the contact does, so that beta
/// pulls otherwise; and null_limit smooths where a contact that is lost is, which counts once it
/// bounces.
INSTANTIATE_TEST_SUITE_P(Variants, PredictedTouchOf,
                         testing::Values(RailCase{Variant::kNullSpace, 1e-9, 1e-9},
                                         RailCase{Variant::kTaskSpace, 1e-9, 1e-9},
                                         RailCase{Variant::kNullTask, 1e-9, 1e-9},
                                         RailCase{Variant::kNullJoint, 1e-9, 0.1},
                                         RailCase{Variant::kNullLimit, 1e-3, 0.4}));

TEST(PredictedTouch, IsNoneWithoutALawOfVelocities) {
  RailTouch touch = railTouch(Variant::kNullSpace, 0.1, 7000.0);
  touch.config.force_control->level = ControlLevel::kAcceleration;
  EXPECT_FALSE(predictedTouch(touch.config, touch.plant, touch.period_s, 0, touch.config.gains));
  touch.config.force_control = ForceControlConfig{.variant = Variant::kJointSpace};
  EXPECT_FALSE(predictedTouch(touch.config, touch.plant, touch.period_s, 0, touch.config.gains));
  touch.config.force_control.reset();
  EXPECT_FALSE(predictedTouch(touch.config, touch.plant, touch.period_s, 0, touch.config.gains));
}

}  // namespace
}  // namespace tactus
