#include <gtest/gtest.h>

#include <stdexcept>

#include "support/controller_run.h"
#include "support/rail_robot.h"

/// A stage that a scene leaves out changes nothing for the others, and the last one is the limiter.
namespace tactus {
namespace {

/// Runs both controllers on the same inputs and expects the same motion to the bit.
void expectSameMotion(const ControllerConfig& a, const ControllerConfig& b, double force_N) {
  const Controller controller_a(a);
  const Controller controller_b(b);
  ControllerState state_a = controller_a.initialState();
  ControllerState state_b = controller_b.initialState();
  ControllerOutput output_a;
  ControllerOutput output_b;
  for (int cycle = 0; cycle < 1500; ++cycle) {
    const RobotInput input{state_a.q_desired, test::touchAt(0.2, force_N, 0.4, cycle + 1)};
    controller_a.update(input, controller_a.initialGains(), cycle * 1e-3, 1e-3, state_a, output_a);
    controller_b.update(input, controller_b.initialGains(), cycle * 1e-3, 1e-3, state_b, output_b);
    test::expectSameMotion(output_a, output_b);
    ASSERT_FALSE(testing::Test::HasFailure()) << "cycle " << cycle;
  }
}

TEST(ControllerStages, TactileModuleAloneChangesNoMotion) {
  test::Random random(241);
  ControllerConfig with = test::fullController(random, 9, Variant::kNone);
  with.force_control.reset();
  ControllerConfig without = with;
  without.tactile_modules.clear();
  expectSameMotion(with, without, 10.0);
}

TEST(ControllerStages, LawNoneChangesNoMotion) {
  test::Random random(242);
  const ControllerConfig with = test::fullController(random, 9, Variant::kNone);
  ControllerConfig without = with;
  without.force_control.reset();
  expectSameMotion(with, without, 10.0);
}

TEST(ControllerStages, LawChangesNoMotionWithoutContact) {
  test::Random random(243);
  for (const Variant variant : test::kAllVariants) {
    const ControllerConfig with = test::fullController(random, 7, variant);
    ControllerConfig without = with;
    without.force_control.reset();
    expectSameMotion(with, without, 1.19);  // below the contact threshold
  }
}

TEST(ControllerStages, AvoidanceWithoutGainChangesNoMotion) {
  test::Random random(244);
  ControllerConfig with = test::fullController(random, 7, Variant::kNullTask);
  with.gains.joint_limit_avoidance.gain = 0.0;
  ControllerConfig without = with;
  without.has_joint_limit_avoidance = false;
  expectSameMotion(with, without, 10.0);
}

TEST(ControllerStages, EstimatorThatNeverTriggersChangesNoMotion) {
  test::Random random(245);
  ControllerConfig with = test::fullController(random, 7, Variant::kNullTask);
  with.gains.force.estimator.min_force_change_N = 1e9;
  ControllerConfig without = with;
  without.force_control->has_estimator = false;
  expectSameMotion(with, without, 10.0);
}

TEST(ControllerStages, AbsentStagesReportZero) {
  test::Random random(246);
  ControllerConfig config = test::fullController(random, 7, Variant::kNone);
  config.force_control.reset();
  config.tactile_modules.clear();
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  controller.update({state.q_desired, test::touchAt(0.2, 10.0, 0.4, 1)}, controller.initialGains(),
                    0.0, 1e-3, state, output);
  test::expectSameContact(output.contact, ContactReport{});
  EXPECT_EQ(output.fault, Fault::kNone);
}

TEST(ControllerStages, RefusesALawWithoutAModule) {
  test::Random random(248);
  ControllerConfig config = test::fullController(random, 7, Variant::kNullSpace);
  config.tactile_modules.clear();
  EXPECT_THROW(Controller{config}, std::invalid_argument);
}

TEST(ControllerStages, RefusesAPostureWithoutJointLimitAvoidance) {
  test::Random random(248);
  ControllerConfig config = test::fullController(random, 7, Variant::kNullSpace);
  config.q_posture = config.q_start;
  EXPECT_NO_THROW(Controller{config});
  config.has_joint_limit_avoidance = false;
  EXPECT_THROW(Controller{config}, std::invalid_argument);
}

TEST(ControllerStages, EveryStagePresentDoesChangeTheMotion) {
  test::Random random(247);
  ControllerConfig config = test::fullController(random, 9, Variant::kNullTask);
  config.q_posture = JointVector::Constant(9, 0.3);
  const auto run = test::record(Controller(config), random, 500);
  for (const int stage : {0, 1, 2}) {
    ControllerConfig less = config;
    if (stage < 2) less.q_posture.reset();
    if (stage == 0) less.has_joint_limit_avoidance = false;
    if (stage == 2) less.force_control.reset();
    const Controller other(less);
    ControllerState state = other.initialState();
    ControllerOutput output;
    int different = 0;
    for (const test::RecordedCycle& cycle : run) {
      other.update(cycle.input, other.initialGains(), cycle.t_s, cycle.period_s, state, output);
      different += output.velocity != cycle.output.velocity;
    }
    EXPECT_GT(different, 100) << "stage " << stage;
  }
}

/// Each joint's own part of it: the contact point is that of the first one.
TEST(LimitedCommand, TellsTheLawWhatIsCutFromTheContactPointsWayOut) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  const Controller free(config);
  config.limits.max_velocity << 1e-3, 1e3;
  const Controller limited(config);
  const RobotInput input{config.q_start, test::touchAt(0.5, 20.0, 0.0, 1)};
  ControllerState free_state = free.initialState(), state = limited.initialState();
  ControllerOutput free_output, output;
  free.update(input, config.gains, 0.0, 1e-3, free_state, free_output);
  limited.update(input, config.gains, 0.0, 1e-3, state, output);
  ASSERT_GT(free_output.velocity[0], 0.01) << "this test is blind";
  EXPECT_EQ(free_state.contact.cut_m_per_s, 0.0);
  EXPECT_NEAR(state.contact.cut_m_per_s, free_output.velocity[0] - output.velocity[0], 1e-12);
}

/// As long as no module is lost there is nothing but the limiter, also where it has to brake joint
/// by joint.
TEST(LimitedCommand, IsThatOfTheLimiterAlone) {
  test::Random random(249);
  int cut = 0;
  for (int i = 0; i < 300; ++i) {
    ControllerConfig config = test::fullController(random, 7, Variant::kNone);
    config.limits.max_velocity.setConstant(1e3);
    config.limits.max_acceleration.setConstant(1e9);
    const Controller free(config);
    config.limits.max_velocity = random.vector(7, 0.02, 0.5);
    config.limits.max_acceleration = random.vector(7, 1.0, 100.0);
    const Controller limited(config);
    ControllerState state = limited.initialState();
    state.q_desired += random.vector(7, -0.1, 0.1);
    const JointVector before =
        config.limits.max_velocity.cwiseProduct(JointVector(random.vector(7, -1.0, 1.0)));
    state.velocity_before = before;
    ControllerState free_state = state;
    const RobotInput input{state.q_desired, test::touchAt(0.2, 0.0, 0.0, 1)};
    ControllerOutput wanted, output;
    free.update(input, config.gains, 0.3, 1e-3, free_state, wanted);
    limited.update(input, config.gains, 0.3, 1e-3, state, output);
    JointVector expected = wanted.velocity;
    CommandLimiter(config.limits).apply(output.q_desired, before, 1e-3, expected);
    cut += expected != wanted.velocity;
    ASSERT_EQ(output.velocity, expected) << i;
  }
  EXPECT_GT(cut, 100);
}

}  // namespace
}  // namespace tactus
