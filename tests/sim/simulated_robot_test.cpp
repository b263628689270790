#include "tactus/sim/simulated_robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "support/closed_loop.h"

namespace tactus {
namespace {

JointVector measured(SimulatedRobot& robot) {
  RobotInput input;
  robot.read(input);
  return input.q_measured;
}

TEST(SimulatedRobot, StartsAtRestAtItsStartPose) {
  const ControllerConfig config = test::crops9Controller();
  SimulatedRobot robot(config, test::crops9Plant({}), 0.001);
  EXPECT_EQ(measured(robot), config.q_start);
  for (int i = 0; i < 100; ++i) robot.write(JointVector::Zero(9));
  EXPECT_EQ(measured(robot), config.q_start);
}

TEST(SimulatedRobot, IdealDrivesFollowAtOnce) {
  const ControllerConfig config = test::crops9Controller();
  PlantConfig plant = test::crops9Plant({});
  plant.drive_lag_s = 0.0;
  SimulatedRobot robot(config, plant, 0.001);
  const JointVector v = JointVector::LinSpaced(9, -0.4, 0.5);
  for (int i = 0; i < 100; ++i) robot.write(v);
  EXPECT_LT((measured(robot) - config.q_start - 0.1 * v).norm(), 1e-13);
}

TEST(SimulatedRobot, DrivesLagBehindByTheirTimeConstant) {
  const ControllerConfig config = test::crops9Controller();
  for (const double period_s : {0.00025, 0.001, 0.004}) {
    SimulatedRobot robot(config, test::crops9Plant({}), period_s);
    const JointVector v = JointVector::Constant(9, 0.5);
    const int cycles = static_cast<int>(std::lround(0.2 / period_s));
    for (int i = 0; i < cycles; ++i) robot.write(v);
    // The steady error e of an exact lag behind steps of v period: e = (e + v period) exp(-T/lag).
    const double behind = 0.2 * 0.5 - (measured(robot)[0] - config.q_start[0]);
    const double rest = std::exp(-period_s / 0.005);
    EXPECT_NEAR(behind, 0.5 * period_s * rest / (1.0 - rest), 1e-12) << period_s;
  }
}

TEST(SimulatedRobot, DrivesMoveAfterTheirDeadTimeAndWithTheirOwnRamp) {
  const ControllerConfig config = test::crops9Controller();
  PlantConfig plant = test::crops9Plant({});
  plant.drive_lag_s = 0.0;
  plant.drives.dead_time_s = 0.0084;
  SimulatedRobot late(config, plant, 0.001);
  plant.drives.max_acceleration = JointVector::Constant(9, 5.0);
  SimulatedRobot ramped(config, plant, 0.001);
  const JointVector v = JointVector::Constant(9, 0.5);
  for (int i = 0; i < 8; ++i) late.write(v);
  EXPECT_EQ(measured(late), config.q_start);
  for (int i = 8; i < 300; ++i) late.write(v);
  for (int i = 0; i < 300; ++i) ramped.write(v);
  EXPECT_LT((measured(late) - config.q_start - (0.3 - 0.0084) * v).norm(), 1e-12);
  // A ramp to v takes v / a, of which half the way is lost, but for half a step.
  const double way = 0.5 * (0.3 - 0.0084 - 0.5 * 0.1);
  EXPECT_NEAR(measured(ramped)[3] - config.q_start[3], way, 0.5 * 0.001);
}

TEST(SimulatedRobot, ALoopOfSecondOrderStandsInPlaceOfTheLag) {
  const ControllerConfig config = test::crops9Controller();
  PlantConfig plant = test::crops9Plant({});
  plant.drives.loop = VelocityLoopConfig{8.0, 0.5};
  plant.drive_lag_s = 0.3;
  SimulatedRobot robot(config, plant, 0.001);
  VelocityLoop loop(*plant.drives.loop, config.q_start, 0.001);
  JointVector q_d = config.q_start, q = q_d;
  for (int i = 0; i < 300; ++i) {
    const JointVector v = JointVector::LinSpaced(9, -0.2, 0.2) * std::sin(0.05 * i);
    robot.write(v);
    q_d += 0.001 * v;
    loop.update(q_d, q);
    ASSERT_LT((measured(robot) - q).norm(), 1e-12);
  }
}

/// Both move the same arm; one drive tells of the motor, the other of the link.
TEST(SimulatedRobot, ReportsTheSideOfTheGearThatItsEncoderIsOn) {
  const ControllerConfig config = test::crops9Controller();
  PlantConfig plant = test::crops9Plant({});
  plant.dynamics.emplace();
  for (int i = 0; i < 9; ++i)
    plant.dynamics->bodies.push_back({2.0, Vector3(0.1, 0.0, 0.0), 0.01 * Matrix3::Identity()});
  plant.dynamics->rotor_inertia = JointVector::Constant(9, 0.5);
  plant.dynamics->gear_stiffness = JointVector::Constant(9, 1e3);
  plant.dynamics->gear_damping = JointVector::Constant(9, 1.0);
  SimulatedRobot of_motors(config, plant, 0.001);
  plant.drives.reports_links = true;
  SimulatedRobot of_links(config, plant, 0.001);
  ChainPose pose;
  double apart = 0.0;
  for (int i = 0; i < 200; ++i) {
    for (SimulatedRobot* robot : {&of_motors, &of_links}) robot->write(JointVector::Ones(9));
    ASSERT_EQ(of_motors.toolPosition(), of_links.toolPosition());
    config.chain.computePose(measured(of_links), pose);
    ASSERT_EQ(framePosition(pose, config.chain.tip()), of_links.toolPosition());
    apart = std::max(apart, (measured(of_motors) - measured(of_links)).norm());
  }
  EXPECT_GT(apart, 1e-3);
}

TEST(SimulatedRobot, StaysWithinItsJointLimits) {
  const ControllerConfig config = test::crops9Controller();
  SimulatedRobot robot(config, test::crops9Plant({}), 0.001);
  for (int i = 0; i < 4000; ++i) {
    robot.write(JointVector::Constant(9, i < 2000 ? 5.0 : -5.0));
    ASSERT_LE((measured(robot) - config.limits.upper).maxCoeff(), 0.0);
    ASSERT_GE((measured(robot) - config.limits.lower).minCoeff(), 0.0);
  }
  EXPECT_LT((measured(robot) - config.limits.lower).norm(), 1e-9) << "nothing was wound up";
}

TEST(SimulatedRobot, FeelsNothingWithoutAModule) {
  const ControllerConfig config = test::crops9Controller();
  SimulatedRobot robot(config, test::crops9Plant(test::scenario1()), 0.001);
  RobotInput input;
  robot.write(JointVector::Zero(9));
  robot.read(input);
  EXPECT_EQ(input.tactile[0].sequence, 0u);
}

TEST(SimulatedRobot, RefusesPeriodsThatDoNotFitTheModule) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
  for (const double bad_s : {0.0015, 0.0007, 0.0, -0.001, std::nan("")})
    EXPECT_THROW(SimulatedRobot(config, test::crops9Plant({}), bad_s), std::invalid_argument)
        << bad_s;
  for (const double good_s : {0.000125, 0.00025, 0.0005, 0.001, 0.002, 0.004})
    EXPECT_NO_THROW(SimulatedRobot(config, test::crops9Plant({}), good_s)) << good_s;
}

TEST(SimulatedRobot, ModuleKeepsItsOwnTimeAtAnyPeriod) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullSpace);
  for (const double period_s : {0.00025, 0.0005, 0.001, 0.002, 0.004}) {
    // A band that is there at once: the filter's answer to a step, after 40 ms of its own time.
    std::vector<ObstacleConfig> obstacles = test::scenario1();
    obstacles[0].x_m = 0.55;
    obstacles[0].y_m = -0.15;
    SimulatedRobot robot(config, test::crops9Plant(obstacles), period_s);
    for (int i = 0; i < std::lround(0.040 / period_s); ++i) robot.write(JointVector::Zero(9));
    RobotInput input;
    robot.read(input);
    EXPECT_EQ(input.tactile[0].sequence, 10u) << period_s;
    const double felt_N = std::hypot(input.tactile[0].force_y_N, input.tactile[0].force_z_N);
    ASSERT_GT(robot.trueForce_N(), 0.01);
    // scipy.signal.lfilter(*scipy.signal.butter(3, 15, fs=1000), numpy.ones(60))[36]
    EXPECT_NEAR(felt_N / robot.trueForce_N(), 0.9348575664699109, 1e-9) << period_s;
  }
}

TEST(SimulatedRobot, EveryModuleFeelsWhatItsOwnCoverMeets) {
  ControllerConfig config = test::crops9Controller(Variant::kNone);
  const TactileModuleConfig first = config.tactile_modules.front();
  config.tactile_modules = {first, first, first};
  config.tactile_modules[2].link.joint = 0;  // out of reach
  std::vector<ObstacleConfig> obstacles = test::scenario1();
  obstacles[0].x_m = 0.55;
  obstacles[0].y_m = -0.15;
  PlantConfig plant = test::crops9Plant(obstacles);
  plant.modules.resize(3, plant.modules.front());
  plant.modules[1].cover_radius_m -= 0.01;
  SimulatedRobot robot(config, plant, 0.001);
  for (int i = 0; i < 400; ++i) robot.write(JointVector::Zero(9));
  RobotInput input;
  robot.read(input);
  EXPECT_GT(robot.trueForce_N(1), 0.01);
  EXPECT_GT(robot.trueForce_N(0), 1.1 * robot.trueForce_N(1)) << "it is thicker";
  EXPECT_EQ(robot.trueForce_N(2), 0.0);
  for (int module = 0; module < 3; ++module) {
    const TactileSample& sample = input.tactile[module];
    EXPECT_EQ(sample.sequence, 100u);
    EXPECT_NEAR(std::hypot(sample.force_y_N, sample.force_z_N), robot.trueForce_N(module), 1e-3);
  }
  EXPECT_EQ(input.tactile[3].sequence, 0u);
  plant.modules.resize(2);
  EXPECT_THROW(SimulatedRobot(config, plant, 0.001), std::invalid_argument);
}

class CyclePeriod : public testing::TestWithParam<std::tuple<double, Variant>> {};

TEST_P(CyclePeriod, GivesTheResultOfOneMillisecond) {
  const auto [period_s, variant] = GetParam();
  const ControllerConfig config = test::crops9Controller(variant);
  const PlantConfig plant = test::crops9Plant(test::scenario1());
  test::ClosedLoop loop(config, plant, period_s);
  test::ClosedLoop reference(config, plant, 0.001);
  double largest_N = 0.0;
  for (double t_s = 0.1; t_s < 9.0; t_s += 0.1) {
    loop.runUntil(t_s);
    reference.runUntil(t_s);
    ASSERT_EQ(loop.output().fault, Fault::kNone);
    EXPECT_NEAR(loop.output().sensed[0].force_N, reference.output().sensed[0].force_N, 0.05)
        << "at " << t_s;
    EXPECT_LT((loop.robot().toolPosition() - reference.robot().toolPosition()).norm(), 1e-3);
    largest_N = std::max(largest_N, loop.output().sensed[0].force_N);
  }
  EXPECT_GT(largest_N, 5.0) << "no contact, nothing compared";
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, CyclePeriod,
                         testing::Combine(testing::Values(0.00025, 0.0005, 0.002, 0.004),
                                          testing::Values(Variant::kNullSpace,
                                                          Variant::kNullTask)));

TEST(SimulatedRobot, ObstaclesAppearAndVanishDuringTheRun) {
  const ControllerConfig config = test::crops9Controller(Variant::kNone);
  std::vector<ObstacleConfig> obstacles = test::scenario1();
  obstacles[0].appears_s = 3.0;
  obstacles[0].vanishes_s = 6.0;
  test::ClosedLoop loop(config, test::crops9Plant(obstacles), 0.001);
  test::ClosedLoop always(config, test::crops9Plant(test::scenario1()), 0.001);
  loop.runUntil(2.99);
  always.runUntil(2.99);
  EXPECT_EQ(loop.robot().trueForce_N(), 0.0);
  loop.runUntil(5.5);
  always.runUntil(5.5);
  EXPECT_GT(loop.robot().trueForce_N(), 1.0);
  EXPECT_NEAR(loop.robot().trueForce_N(), always.robot().trueForce_N(), 1e-12);
  loop.runUntil(6.01);
  EXPECT_EQ(loop.robot().trueForce_N(), 0.0);
}

TEST(SimulatedRobot, RunsRepeatToTheBit) {
  const ControllerConfig config = test::crops9Controller(Variant::kNullTask, true);
  PlantConfig plant = test::crops9Plant(test::scenario2());
  plant.modules[0].quantised = true;
  plant.modules[0].noise_N = 0.02;
  test::ClosedLoop first(config, plant, 0.001);
  test::ClosedLoop second(config, plant, 0.001);
  for (double t_s = 0.05; t_s < 10.0; t_s += 0.05) {
    first.runUntil(t_s);
    second.runUntil(t_s);
    ASSERT_EQ(first.input().q_measured, second.input().q_measured);
    ASSERT_EQ(first.output().velocity, second.output().velocity);
    ASSERT_EQ(first.input().tactile[0].force_y_N, second.input().tactile[0].force_y_N);
  }
}

}  // namespace
}  // namespace tactus
