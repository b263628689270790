#include <gtest/gtest.h>

#include <vector>

#include "support/controller_run.h"
#include "support/rail_robot.h"

/// Controllers at the acceleration level on random robots.
namespace tactus {
namespace {

constexpr double kCycle_s = 0.001;

ControllerConfig accelerationController(test::Random& random, int count, int task_size,
                                        Variant variant) {
  ControllerConfig config = test::randomController(random, count, task_size);
  config.weights = test::randomWeights(random, count);
  config.force_control.emplace();
  config.force_control->variant = variant;
  config.force_control->level = ControlLevel::kAcceleration;
  config.gains.task.drift_gain_per_s = 5.0;
  return config;
}

TEST(AccelerationLevel, HasNoLawForOtherVariants) {
  test::Random random(501);
  for (const Variant variant : {Variant::kJointSpace, Variant::kTaskSpace, Variant::kNullJoint})
    EXPECT_THROW(Controller(accelerationController(random, 7, 3, variant)), std::invalid_argument);
  ControllerConfig first = accelerationController(random, 7, 3, Variant::kNullSpace);
  first.force_control->order = 1;
  EXPECT_THROW(Controller{first}, std::invalid_argument);
}

/// The tool stays where it is, however the null space moves.
TEST(AccelerationLevel, KeepsItsTaskWhileTheNullSpaceGivesWay) {
  test::Random random(502);
  double moved = 0.0;
  for (int i = 0; i < 40; ++i) {
    const int count = random.integer(4, 12);
    const int task_size = random.integer(1, std::min(count - 2, 6));
    const Controller controller(
        accelerationController(random, count, task_size, Variant::kNullSpace));
    ControllerState state = controller.initialState();
    ControllerOutput output;
    test::RandomTouches touches(random);
    bool is_regular = true;
    for (int cycle = 0; cycle < 1000; ++cycle) {
      controller.update(touches.next(state.q_desired), controller.initialGains(), 0.0, kCycle_s,
                        state, output);
      // Where a cycle turns the arm by more than that, one step of Euler's is far off.
      is_regular = is_regular && output.velocity.cwiseAbs().maxCoeff() < 2.0;
      if (!is_regular) break;
      ASSERT_LT(output.error.norm(), 1e-3) << i << " " << cycle;
      moved = std::max(moved, (state.q_desired - controller.config().q_start).norm());
    }
  }
  EXPECT_GT(moved, 0.05);
}

/// Without contact it is the motion of the velocity level, whatever k_v is.
TEST(AccelerationLevel, MovesFreelyAsTheVelocityLevelDoes) {
  test::Random random(503);
  for (int i = 0; i < 10; ++i) {
    ControllerConfig config = accelerationController(random, 7, 3, Variant::kNullTask);
    config.weights.setOnes();
    config.task.components = {0, 1, 2};
    Waypoint there;
    there.displacement_m = random.vector<Vector3>(3, -0.05, 0.05);
    config.task.trajectory = {0.1, {there}};
    config.gains.force.velocity_gain_per_s = random.logUniform(20.0, 1000.0);
    const Controller smooth(config);
    config.force_control->level = ControlLevel::kVelocity;
    const Controller direct(config);
    ControllerState smooth_state = smooth.initialState(), direct_state = direct.initialState();
    ControllerOutput expected, output;
    double fastest = 0.0;
    for (int cycle = 0; cycle < 2000; ++cycle) {
      const RobotInput untouched{direct_state.q_desired,
                                 {test::touchAt(0.2, 0.0, 0.0, cycle / 4 + 1)}};
      direct.update(untouched, direct.initialGains(), cycle * kCycle_s, kCycle_s, direct_state,
                    expected);
      smooth.update(untouched, smooth.initialGains(), cycle * kCycle_s, kCycle_s, smooth_state,
                    output);
      ASSERT_LT((output.velocity - expected.velocity).norm(), 2e-3) << i << " " << cycle;
      fastest = std::max(fastest, expected.velocity.norm());
    }
    EXPECT_GT(fastest, 0.02);
  }
}

/// Next to no k_v has to bring the tool back: that joints which turn accelerate it is known. In
/// position and, of nine joints, in orientation.
TEST(AccelerationLevel, FollowsAPathThatTurnsItsJoints) {
  test::Random random(506);
  for (int i = 0; i < 10; ++i) {
    ControllerConfig config = accelerationController(random, 9, 3, Variant::kNullSpace);
    const bool turns = i % 2 != 0;
    config.task.components = turns ? std::array{3, 4, 5, 0, 1, 2} : std::array{0, 1, 2, 3, 4, 5};
    config.gains.force.velocity_gain_per_s = 1e-3;
    Waypoint there;
    (turns ? there.rotation_vector_rad : there.displacement_m) =
        random.vector<Vector3>(3, -0.2, 0.2);
    there.speed_m_per_s = 0.2;
    config.task.trajectory = {0.1, {there}};
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    double apart = 0.0;
    for (int cycle = 0; cycle < 2000; ++cycle) {
      controller.update({state.q_desired, {test::touchAt(0.2, 0.0, 0.0, cycle + 1)}},
                        controller.initialGains(), cycle * kCycle_s, kCycle_s, state, output);
      apart = std::max(apart, output.error.norm());
    }
    EXPECT_LT(apart, 5e-4) << i;
  }
}

/// The approach limit of null_limit is what v is led to by k_v: at once where that is large.
TEST(AccelerationLevel, LimitsTheApproachAsTheVelocityLevelDoesWithALargeGain) {
  ControllerConfig config = test::undelayedRail(0.05, 2000.0);
  config.gains.force.max_null_speed_m_per_s = 1e-12;
  config.gains.force.velocity_gain_per_s = 1e9;
  const test::RailWorld world{2000.0, 0.01};
  std::vector<double> forces_N;
  for (const ControlLevel level : {ControlLevel::kVelocity, ControlLevel::kAcceleration}) {
    config.force_control->level = level;
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    for (int cycle = 0; cycle < 2000; ++cycle) {
      controller.update(world.input(state), config.gains, cycle * kCycle_s, kCycle_s, state,
                        output);
      const double force_N = world.force_N(state.q_desired);
      if (level == ControlLevel::kVelocity) {
        forces_N.push_back(force_N);
      } else {
        ASSERT_NEAR(force_N, forces_N[cycle], 0.02) << cycle;
      }
    }
  }
  EXPECT_NEAR(forces_N.back(), config.gains.force.activation_force_N, 0.01);
}

/// On a rail, where nothing turns, the way off the limits is that of the velocity level, whatever
/// k_v is.
TEST(AccelerationLevel, LeavesLimitsAsTheVelocityLevelDoes) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.limits.lower.setConstant(-1.0);
  config.limits.upper << 0.2, 3.0;
  config.has_joint_limit_avoidance = true;
  config.gains.joint_limit_avoidance.active_fraction = 1.0;
  config.gains.force.velocity_gain_per_s = 1e-3;
  const Controller direct(config);
  config.force_control->level = ControlLevel::kAcceleration;
  const Controller smooth(config);
  ControllerState direct_state = direct.initialState();
  ControllerOutput expected, output;
  const auto update = [&](const Controller& controller, ControllerState& state,
                          ControllerOutput& to) {
    controller.update({state.q_desired, {test::touchAt(0.5, 0.0, 0.0, 1)}}, config.gains, 0.0,
                      kCycle_s, state, to);
  };
  update(direct, direct_state, expected);
  ControllerState state = direct_state;
  const double first = expected.velocity[0];
  for (int cycle = 0; cycle < 1000; ++cycle) {
    update(direct, direct_state, expected);
    update(smooth, state, output);
    ASSERT_LT((output.velocity - expected.velocity).norm(), 0.01 * std::abs(first)) << cycle;
  }
  EXPECT_LT(std::abs(expected.velocity[0]), 0.5 * std::abs(first)) << "this test is blind";
  EXPECT_LT(state.q_desired[0], -0.01);
}

TEST(AccelerationLevel, StaysWithinAllLimits) {
  test::Random random(504);
  for (int i = 0; i < 60; ++i) {
    const int count = random.integer(3, 16);
    const Variant variant = test::kAccelerationVariants[i % 3];
    ControllerConfig config =
        test::fullController(random, count, variant, ControlLevel::kAcceleration);
    config.limits = test::randomLimits(random, count);
    config.q_start = config.q_start.cwiseMax(config.limits.lower).cwiseMin(config.limits.upper);
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    test::RandomTouches touches(random);
    for (int cycle = 0; cycle < 500; ++cycle) {
      const JointVector before = state.velocity_before;
      controller.update(touches.next(state.q_desired), controller.initialGains(), cycle * kCycle_s,
                        kCycle_s, state, output);
      const JointVector change =
          config.limits.max_acceleration.cwiseMin(1e12) * kCycle_s * (1.0 + 1e-9);
      ASSERT_TRUE(output.velocity.allFinite());
      for (int k = 0; k < count; ++k) {
        ASSERT_LE(std::abs(output.velocity[k]), config.limits.max_velocity[k]);
        ASSERT_LE(std::abs(output.velocity[k] - before[k]), change[k]);
        ASSERT_GE(state.q_desired[k], config.limits.lower[k]);
        ASSERT_LE(state.q_desired[k], config.limits.upper[k]);
      }
    }
  }
}

RobotInput touchedBy(double force_N, const ControllerState& state) {
  const std::uint32_t next = state.modules[0].sequence + 1;
  return {state.q_desired, {test::touchAt(0.2, force_N, 0.0, next)}};
}

/// What pushed before a hold, or in it, is gone after it: as if the arm had always stood there.
TEST(AccelerationLevel, RemembersNothingOfAContactAfterAHold) {
  test::Random random(505);
  for (const Variant variant : test::kAccelerationVariants) {
    const Controller controller(accelerationController(random, 7, 3, variant));
    ControllerState state = controller.initialState();
    ControllerOutput output;
    const auto run = [&](double force_N, int cycles) {
      for (int i = 0; i < cycles; ++i)
        controller.update(touchedBy(force_N, state), controller.initialGains(), 0.0, kCycle_s,
                          state, output);
    };
    run(15.0, 300);
    EXPECT_GT(output.velocity.cwiseAbs().maxCoeff(), 1e-3);
    state.is_stopping = true;
    run(15.0, 300);
    run(0.0, 300);
    EXPECT_TRUE(output.velocity.isZero(0.0));
    state.is_stopping = false;
    ControllerState fresh = controller.initialState(state.q_desired);
    ControllerOutput expected;
    for (int i = 0; i < 1000; ++i) {
      controller.update(touchedBy(0.0, fresh), controller.initialGains(), 0.0, kCycle_s, fresh,
                        expected);
      run(0.0, 1);
      ASSERT_LT((output.velocity - expected.velocity).norm(), 1e-12) << i;
    }
  }
}

/// With what the reference accelerates by, a tool that is told where to go does not lag behind it.
TEST(AccelerationLevel, FollowsAToolThatIsToldWhereToGo) {
  test::Random random(505);
  for (int i = 0; i < 10; ++i) {
    ControllerConfig config = accelerationController(random, 7, 3, Variant::kNullSpace);
    config.task.components = {0, 1, 2};
    config.task.commands.emplace();
    const Controller controller(config);
    ControllerState state = controller.initialState();
    Pose target = tipPose(config.chain, config.q_start);
    target.p_AB += random.vector<Vector3>(3, -0.05, 0.05);
    state.tool_motion = state.tool_motion->to(0.0, target, {});
    ControllerOutput output;
    double fastest_m_per_s = 0.0;
    for (int cycle = 0; cycle < 3000; ++cycle) {
      controller.update({state.q_desired, {test::touchAt(0.2, 0.0, 0.0, cycle / 4 + 1)}},
                        controller.initialGains(), cycle * kCycle_s, kCycle_s, state, output);
      fastest_m_per_s = std::max(fastest_m_per_s, output.w_d_dot.head<3>().norm());
      ASSERT_LT(output.error.norm(), 3e-4) << i << " " << cycle;
    }
    EXPECT_GT(fastest_m_per_s, 0.01);
    EXPECT_LT((tipPose(config.chain, state.q_desired).p_AB - target.p_AB).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace tactus
