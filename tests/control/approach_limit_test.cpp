#include "tactus/control/approach_limit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/controller_run.h"
#include "support/crops9.h"
#include "support/period.h"
#include "support/rail_robot.h"

namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kT_s = 0.1;
constexpr double kLimit_N = 3.8;
constexpr double kC_N_per_m = 1000.0;

/// The null space cannot do anything.
ControllerConfig bareRail(double speed_m_per_s) {
  ControllerConfig config = test::undelayedRail(speed_m_per_s, kC_N_per_m);
  config.gains.force.max_null_speed_m_per_s = 1e-12;
  return config;
}

const ForceGains kGains = bareRail(0.1).gains.force;

TEST(ApproachLimit, LetsTheForceSettleExponentiallyAtTheActivationForce) {
  const Controller controller(bareRail(10.0));
  test::RailWorld world{kC_N_per_m, 0.0};
  ControllerState state = controller.initialState();
  ControllerOutput output;
  double force_N = 0.0;
  double largest_N = 0.0;
  for (int cycle = 0; cycle < 1000; ++cycle) {
    const double before_N = force_N;
    controller.update(world.input(state), controller.initialGains(), cycle * kPeriod_s, kPeriod_s,
                      state, output);
    force_N = world.force_N(state.q_desired);
    largest_N = std::max(largest_N, force_N);
    if (cycle < 20) continue;  // until it is felt, nothing limits
    // dF/dt = -(F - F_act) / T, one explicit step of it.
    const double expected_N = -kPeriod_s / kT_s * (before_N - kLimit_N);
    ASSERT_NEAR(force_N - before_N, expected_N, 0.05 * std::abs(expected_N) + 1e-5) << cycle;
  }
  EXPECT_NEAR(force_N, kLimit_N, 1e-3);
}

/// The task gives way then, and the null space would have to take back what it gathered meanwhile.
TEST(ApproachLimit, NothingIsIntegratedWhileItHoldsTheArmBack) {
  ControllerConfig config = test::undelayedRail(0.0, kC_N_per_m);
  config.task.trajectory.waypoints.clear();
  config.gains.force.damping = 0.1;  // P = 0.002 m/(s N), v_max = (F_act - F) 0.01 m/(s N)
  const Controller controller(config);
  const auto integralAfter = [&](double force_N) {
    ControllerState state = controller.initialState();
    ControllerOutput output;
    for (std::uint32_t cycle = 0; cycle < 20; ++cycle)
      controller.update({state.q_desired, {test::touchAt(0.5, -force_N, 0.0, cycle + 1)}},
                        config.gains, cycle * kPeriod_s, kPeriod_s, state, output);
    return state.contact.law.V_m_per_s;
  };
  const double rate_m_per_s = kPeriod_s * 4.0 / (kT_s * kT_s * kC_N_per_m);
  EXPECT_NEAR(integralAfter(4.0), 20.0 * rate_m_per_s, 1e-12);  // -P 4 N is faster than v_max
  EXPECT_LE(integralAfter(20.0), 2.0 * 5.0 * rate_m_per_s);     // -P 20 N is not
}

/// A contact that swings about F_th would else be taken for the assumed one after a while.
TEST(ApproachLimit, KnowsAContactAsLongAsItIsFelt) {
  ControllerConfig config = bareRail(0.1);
  config.force_control->has_estimator = true;
  const ApproachLimit limit(config, config.tactile_modules.front());
  ForceGains gains = kGains;
  gains.contact_threshold_N = 1.2;
  const auto stiffnessAfter = [&](double nearness) {
    ApproachLimitState state = limit.initialState();
    state.estimator.stiffness_N_per_m = 50.0 * kC_N_per_m;
    for (int i = 0; i < 5000; ++i)
      limit.observe(gains, ScaledVector::Zero(), {0.0, nearness}, config.q_start, kPeriod_s, state);
    return state.estimator.stiffness_N_per_m;
  };
  EXPECT_EQ(stiffnessAfter(1.0), 50.0 * kC_N_per_m);
  EXPECT_NEAR(stiffnessAfter(0.0), kC_N_per_m, 0.01 * 50.0 * kC_N_per_m);
}

/// Who presses on an arm that rests makes its contact no stiffer, though the filter still tells of
/// its last way. When it moves on, the force counts from then on.
TEST(ApproachLimit, LearnsNothingOfWhoPressesOnAnArmAtRest) {
  ControllerConfig config = bareRail(0.1);
  config.force_control->has_estimator = true;
  const ApproachLimit limit(config, config.tactile_modules.front());
  const ScaledVector a = -ScaledVector::Unit(0);
  JointVector q = JointVector::Zero(2);
  ApproachLimitState touched = limit.initialState();
  const auto observe = [&](double F_p_N, bool is_at_rest, ApproachLimitState& state) {
    state.smoother.contact.interval_s = kPeriod_s;
    state.smoother.significant_N = 0.01;
    limit.observe(kGains, a, {F_p_N, 1.0}, q, kPeriod_s, state);
    if (is_at_rest) limit.rest(kGains, F_p_N, state);
  };
  for (int i = 0; i < 100; ++i) {
    q[0] += 1e-5;
    observe(kC_N_per_m * q[0], false, touched);
  }
  const double c_N_per_m = touched.estimator.stiffness_N_per_m;
  const auto stiffnessAfter = [&](bool is_at_rest) {
    ApproachLimitState state = touched;
    for (int i = 0; i < 50; ++i) observe(1.0 + 0.1 * i, is_at_rest, state);
    q[0] += 1e-4;
    observe(5.9, false, state);
    q[0] -= 1e-4;
    EXPECT_EQ(state.memory_N_per_m, state.estimator.stiffness_N_per_m);
    return state.estimator.stiffness_N_per_m;
  };
  EXPECT_GT(stiffnessAfter(false), 3.0 * c_N_per_m) << "else this test is blind";
  EXPECT_EQ(stiffnessAfter(true), c_N_per_m);
}

/// What an arm at rest has forgotten of a contact that is gone stays so when it is pressed anew.
TEST(ApproachLimit, ForgetsAContactThatGoesWhileTheArmRests) {
  ControllerConfig config = bareRail(0.1);
  config.force_control->has_estimator = true;
  const ApproachLimit limit(config, config.tactile_modules.front());
  ApproachLimitState state = limit.initialState();
  const auto rest = [&](double F_p_N) {
    state.smoother.contact.interval_s = kPeriod_s;
    state.smoother.significant_N = 0.01;
    limit.observe(kGains, -ScaledVector::Unit(0), {F_p_N, 0.0}, config.q_start, kPeriod_s, state);
    limit.rest(kGains, F_p_N, state);
  };
  rest(0.0);
  EXPECT_EQ(state.memory_N_per_m, 0.0) << "nothing was touched";
  state.estimator.stiffness_N_per_m = state.rested_N_per_m = 20.0 * kC_N_per_m;
  rest(0.5);
  EXPECT_EQ(state.estimator.stiffness_N_per_m, 20.0 * kC_N_per_m);
  EXPECT_EQ(state.memory_N_per_m, 20.0 * kC_N_per_m);
  for (int i = 0; i < 20000; ++i) rest(0.0);
  EXPECT_NEAR(state.estimator.stiffness_N_per_m, kC_N_per_m, 1.0);
  rest(0.5);
  EXPECT_NEAR(state.estimator.stiffness_N_per_m, kC_N_per_m, 1.0);
}

/// What was commanded since the last sample counts as gone; the next sample tells of it.
TEST(ApproachLimit, LooksAheadAsFarAsNoSampleHasToldOf) {
  ControllerConfig config = bareRail(0.1);
  config.drive_lag_s = 0.0;
  const ApproachLimit limit(config, config.tactile_modules.front());
  ApproachLimitState state = limit.initialState();
  ScaledVector a = ScaledVector::Zero();
  a[0] = -0.5;  // the obstacle is where the first joint leads
  JointVector q = config.q_start;
  const auto observe = [&](double interval_s) {
    state.smoother.contact.interval_s = interval_s;
    limit.observe(kGains, a, {1.0, 1.0}, q, kPeriod_s, state);
  };
  observe(kPeriod_s);
  EXPECT_EQ(state.way_ahead_m, 0.0);
  for (int cycle = 1; cycle <= 4; ++cycle) {
    q[0] += 0.01;
    observe(0.0);
    EXPECT_NEAR(state.way_ahead_m, 0.005 * cycle, 1e-15);
  }
  for (int cycle = 0; cycle < 1000; ++cycle) observe(kPeriod_s);  // the module's filter
  EXPECT_NEAR(state.way_ahead_m, 0.0, 1e-9);
}

/// What is taken for the stiffness at first is replaced by force over way: at once by more, as the
/// arm else came too fast, and by less in its time.
TEST(ApproachLimit, LearnsHowStiffTheContactIs) {
  for (const double ratio : {0.3, 3.0}) {
    ControllerConfig config = bareRail(0.01);
    config.force_control->has_estimator = true;
    config.gains.force.assumed_stiffness_N_per_m = ratio * kC_N_per_m;
    const Controller controller(config);
    const test::RailWorld world{kC_N_per_m, 0.001};
    ControllerState state = controller.initialState();
    ControllerOutput output;
    for (int cycle = 0; cycle < 1000; ++cycle)
      controller.update(world.input(state), config.gains, cycle * kPeriod_s, kPeriod_s, state,
                        output);
    EXPECT_GT(output.contact.stiffness_N_per_m, 0.95 * kC_N_per_m) << ratio;
    EXPECT_LT(output.contact.stiffness_N_per_m, (ratio < 1.0 ? 1.3 : 2.1) * kC_N_per_m);
  }
}

/// Drift of the sensor, or what is left of a cover's weight, between F_rel and F_th looks like a
/// contact that is about to be lost.
TEST(ApproachLimit, AnOffsetBelowTheThresholdDoesNotMoveTheArmOnAndOn) {
  for (const double c_N_per_m : {30.0, 7000.0}) {
    SCOPED_TRACE(c_N_per_m);
    ControllerConfig config = test::crops9Controller(Variant::kNullLimit, true);
    config.task.trajectory.waypoints.clear();
    const TactileModuleConfig& module = config.tactile_modules.front();
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    RobotInput input;
    ChainPose pose;
    const auto run = [&](double force_N, double duration_s) {
      for (long i = 0; i < std::lround(duration_s / kPeriod_s); ++i) {
        input.q_measured = state.q_desired;
        const std::uint32_t next = input.tactile[0].sequence + (i % 4 == 0 ? 1 : 0);
        input.tactile[0] = test::touchAt(0.2, force_N, 2.8, next);
        controller.update(input, controller.initialGains(), 0.0, kPeriod_s, state, output);
      }
      config.chain.computePose(state.q_desired, pose);
      const Pose X = framePose(pose, module.link);
      return Vector3(X.p_AB + 0.2 * X.R_AB.col(0));
    };
    run(2.0, 0.5);
    state.contact.approach.estimator.stiffness_N_per_m = c_N_per_m;
    const Vector3 lost = run(1.3, 0.1);
    const Vector3 later = run(0.7, 30.0);
    EXPECT_LT((later - lost).norm(), 1.2 * controller.initialGains().force.transition.distance_m);
    EXPECT_LT((run(0.7, 10.0) - later).norm(), 1e-3);
    EXPECT_NEAR(state.contact.approach.estimator.stiffness_N_per_m, 7000.0, 1000.0);
  }
}

TEST(ApproachLimit, CutsExactlyTheExcessByHand) {
  const ControllerConfig config = bareRail(0.1);
  const ApproachLimit limit(config, config.tactile_modules.front());
  ApproachLimitState state = limit.initialState();
  state.memory_N_per_m = 2000.0;  // T m = 200 Ns/m
  EXPECT_EQ(limit.excess(kGains, 1.8, -0.0099, state), 0.0) << "2 N are left: 10 mm/s";
  EXPECT_FALSE(state.is_limiting);
  EXPECT_NEAR(limit.excess(kGains, 1.8, -0.0125, state), -0.0025, 1e-15);
  EXPECT_TRUE(state.is_limiting);
  EXPECT_NEAR(limit.excess(kGains, 5.8, 0.004, state), -0.006, 1e-15)
      << "back at 10 mm/s, 4 of it by others";
  EXPECT_EQ(limit.excess(kGains, kLimit_N, 0.0, state), 0.0);
  EXPECT_FALSE(state.is_limiting) << "at rest at F_act";
  state.way_ahead_m = 1e-3;  // 2 N more
  EXPECT_NEAR(limit.excess(kGains, 1.8, -0.0125, state), -0.0125, 1e-15);
  state.way_ahead_m = -1.0;
  EXPECT_NEAR(limit.excess(kGains, 1.8, -0.05, state), -0.05 + 3.8 / 200.0, 1e-15)
      << "no force is less than none";
}

TEST(ApproachLimit, TakesTheObstaclesSpeedOffTheApproach) {
  const ControllerConfig config = bareRail(0.1);
  const ApproachLimit limit(config, config.tactile_modules.front());
  ApproachLimitState state = limit.initialState();
  state.memory_N_per_m = 2000.0;
  state.obstacle.v_m_per_s = 0.002;
  EXPECT_EQ(limit.excess(kGains, 1.8, -0.0079, state), 0.0);
  EXPECT_NEAR(limit.excess(kGains, 1.8, -0.0125, state), -0.0045, 1e-15);
  SpeedRows rows;
  rows.size = 1;
  limit.limitRows(kGains, 1.8, 0.5, 1.0, state, 0, rows);
  EXPECT_NEAR(rows.row[0].v_max_m_per_s, 0.5 * 0.008, 1e-15);
  EXPECT_EQ(rows.row[0].presence, 1.0);
  limit.limitRows(kGains, 0.0, 0.5, 1.0, state, 0, rows);
  EXPECT_NEAR(rows.row[0].v_max_m_per_s, 0.5 * (kLimit_N / 200.0 - 0.002), 1e-15);
  const ScaledVector a = -ScaledVector::Unit(0);
  limit.observe(kGains, a, {0.0, 0.0}, JointVector::Zero(2), kPeriod_s, state);
  EXPECT_EQ(state.obstacle.v_m_per_s, 0.0) << "forgotten without contact";
}

/// Force at rest of an obstacle of 7000 N/m against an arm that knows it.
double restingForce_N(double coming_m_per_s) {
  ControllerConfig config = bareRail(0.1);
  config.gains.force.assumed_stiffness_N_per_m = 7000.0;
  config.gains.force.contact_threshold_N = 1.2;
  const Controller controller(config);
  test::RailWorld world{7000.0, 0.01};
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int cycle = 0; cycle < 6000; ++cycle) {
    world.surface_m -= coming_m_per_s * kPeriod_s;
    controller.update(world.input(state), controller.initialGains(), cycle * kPeriod_s, kPeriod_s,
                      state, output);
  }
  return world.force_N(state.q_desired);
}

TEST(ApproachLimit, ASoftObstacleThatComesRestsWithinOneAndAHalfOfTheLimit) {
  EXPECT_NEAR(restingForce_N(0.0), 5.0, 0.01);
  // F_act + F_th + T m v_o = 8.5 N, less half of F_act + F_th.
  EXPECT_NEAR(restingForce_N(0.005), 6.0, 0.05);
  EXPECT_LT(restingForce_N(0.003), 5.55) << "known within a tenth";
  EXPECT_GT(restingForce_N(-0.005), 0.0);
  EXPECT_LT(restingForce_N(-0.005), 5.0);
}

TEST(ApproachLimit, MemoryFadesAfterContactAndThenLimitsNothing) {
  const ControllerConfig config = bareRail(0.1);
  const ApproachLimit limit(config, config.tactile_modules.front());
  ApproachLimitState state = limit.initialState();
  const JointVector q = JointVector::Zero(2);
  const ScaledVector a = -ScaledVector::Unit(0);
  EXPECT_EQ(limit.excess(kGains, 0.0, -1e9, state), 0.0) << "before the first contact";
  limit.observe(kGains, a, {1.0, 1.0}, q, kPeriod_s, state);
  EXPECT_EQ(state.memory_N_per_m, kC_N_per_m);
  for (int i = 0; i < 100; ++i) limit.observe(kGains, a, {0.0, 0.0}, q, kPeriod_s, state);
  EXPECT_NEAR(state.memory_N_per_m, kC_N_per_m * std::exp(-1.0), 1e-6);
  for (int i = 0; i < 20000; ++i) limit.observe(kGains, a, {0.0, 0.0}, q, kPeriod_s, state);
  EXPECT_EQ(state.memory_N_per_m, 0.0) << "and not a denormal number";
  EXPECT_EQ(limit.excess(kGains, 0.0, -1e9, state), 0.0);
}

TEST(ApproachLimit, SofterContactIsApproachedNoFasterThanTheFloorAllows) {
  ControllerConfig config = bareRail(0.1);
  config.gains.force.assumed_stiffness_N_per_m = 20.0;
  const ApproachLimit limit(config, config.tactile_modules.front());
  ApproachLimitState state = limit.initialState();
  limit.observe(config.gains.force, -ScaledVector::Unit(0), {1.0, 1.0}, JointVector::Zero(2),
                kPeriod_s, state);
  EXPECT_EQ(state.memory_N_per_m, 300.0);
}

/// A robot that nothing limits, touched at one point of its cover, pushed towards what touches it.
struct TouchedRobot {
  explicit TouchedRobot(test::Random& random)
      : n(random.integer(4, 12)),
        config(test::randomController(random, n, random.integer(1, 3))),
        x_m(random.uniform(0.05, 0.35)),
        angle_rad(random.uniform(-3.0, 3.0)) {
    config.force_control.emplace();
    config.force_control->variant = Variant::kNullLimit;
    if (random.chance(0.7)) config.force_control->has_estimator = true;
    config.limits.upper = JointVector::Constant(n, 50.0);
    config.limits.lower = -config.limits.upper;
    if (random.chance(0.5)) {
      config.has_joint_limit_avoidance = true;
      config.gains.joint_limit_avoidance.active_fraction = 1.0;
    }
    Waypoint line;
    line.displacement_m = random.vector<Vector3>(3, -5.0, 5.0);
    line.rotation_vector_rad = random.vector<Vector3>(3, -1.0, 1.0);
    line.speed_m_per_s = random.logUniform(0.01, 1.0);
    config.task.trajectory = {0.05, {line}};
  }

  /// Speed of the contact, as smoothed, towards what touches it, by differences.
  double approach(const ContactPointState& contact, const ControllerOutput& output) const {
    const double h = 1e-6;
    const Vector3 way = point(contact.position_m, output.q_desired + h * output.velocity) -
                        point(contact.position_m, output.q_desired - h * output.velocity);
    ChainPose pose;
    config.chain.computePose(output.q_desired, pose);
    const Matrix3 R = framePose(pose, config.tactile_modules.front().link).R_AB;
    return -way.dot(R * contact.direction) / (2.0 * h);
  }

  Vector3 point(double along_m, const JointVector& q) const {
    ChainPose pose;
    config.chain.computePose(q, pose);
    const Pose X = framePose(pose, config.tactile_modules.front().link);
    return X.p_AB + along_m * X.R_AB.col(0);
  }

  int n;
  ControllerConfig config;
  double x_m, angle_rad;
};

TEST(ApproachLimit, IsNeverExceededByTheCommand) {
  test::Random random(331);
  int limited = 0;
  int compared = 0;
  for (int i = 0; i < 150; ++i) {
    const TouchedRobot robot(random);
    const Controller controller(robot.config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    double force_N = 0.0;
    for (int cycle = 0; cycle < 300; ++cycle) {
      if (cycle % 4 == 0) force_N = std::max(0.0, force_N + random.uniform(-0.5, 0.6));
      const RobotInput input{state.q_desired,
                             test::touchAt(robot.x_m, force_N, robot.angle_rad, cycle / 4 + 1)};
      controller.update(input, controller.initialGains(), cycle * kPeriod_s, kPeriod_s, state,
                        output);
      ASSERT_TRUE(output.velocity.allFinite());
      const ContactReport& contact = output.contact;
      if (contact.k_t < std::max(1.01e-3 * contact.k_j, 1.01e-4)) continue;
      const ApproachLimitState& approach = state.contact.approach;
      const double m = approach.memory_N_per_m;
      if (m == 0.0) continue;
      const double F_N = std::max(0.0, contact.force_contact_N + m * approach.way_ahead_m);
      const double v_max = (kLimit_N - F_N) / (kT_s * m) - approach.obstacle.v_m_per_s;
      const double v = robot.approach(approach.smoother.contact, output);
      const double tolerance = 1e-6 * (1.0 + output.velocity.norm());
      ASSERT_LE(v, v_max + tolerance) << "robot " << i << ", cycle " << cycle;
      if (contact.u_t < 0.0) {
        ASSERT_NEAR(v, v_max, tolerance) << "no more than the excess is cut";
        ++limited;
      }
      ++compared;
    }
  }
  EXPECT_GT(limited, 2000);
  EXPECT_GT(compared, 10000);
}

TEST(ApproachLimit, NothingMovesTheTaskOnceTheMemoryHasFaded) {
  test::Random random(332);
  for (int i = 0; i < 20; ++i) {
    TouchedRobot robot(random);
    const Controller controller(robot.config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    for (int cycle = 0; cycle < 8000; ++cycle) {
      const double force_N = cycle < 200 ? 10.0 : 0.0;
      const RobotInput input{state.q_desired,
                             test::touchAt(robot.x_m, force_N, robot.angle_rad, cycle + 1)};
      controller.update(input, controller.initialGains(), cycle * kPeriod_s, kPeriod_s, state,
                        output);
      ASSERT_TRUE(output.velocity.allFinite());
    }
    EXPECT_EQ(output.contact.u_t, 0.0);
    EXPECT_EQ(state.contact.approach.memory_N_per_m, 0.0);
  }
}

TEST(ApproachLimit, StaysFiniteWhateverTheSensorSays) {
  test::Random random(333);
  for (int i = 0; i < 30; ++i) {
    TouchedRobot robot(random);
    robot.config.tactile_modules.front().max_force_N = 1e9;
    robot.config.limits.max_velocity = JointVector::Constant(robot.n, 5.0);
    robot.config.limits.max_acceleration = JointVector::Constant(robot.n, 200.0);
    const Controller controller(robot.config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    std::uint32_t sequence = 0;
    for (int cycle = 0; cycle < 1000; ++cycle) {
      if (random.chance(0.5)) ++sequence;
      TactileSample sample = test::touchAt(random.uniform(-1.0, 1.0),
                                           random.chance(0.3) ? 0.0 : random.logUniform(1e-6, 1e8),
                                           random.uniform(-4.0, 4.0), sequence);
      controller.update({state.q_desired, sample}, controller.initialGains(), cycle * kPeriod_s,
                        kPeriod_s, state, output);
      ASSERT_TRUE(output.velocity.allFinite()) << i << ", " << cycle;
      ASSERT_NE(output.fault, Fault::kCommandNotFinite);
    }
  }
}

}  // namespace
}  // namespace tactus
