#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/period.h"

/// What a stop leaves of an arm's state, and how the way out of joint limits' zones comes back.
namespace tactus {
namespace {

using test::kPeriod_s;

/// An arm in its joints' zones that follows their gradient alone.
struct ArmInItsZones {
  ArmInItsZones() {
    config.tactile_modules.clear();
    config.gains.task.drift_gain_per_s = 0.0;
    config.has_joint_limit_avoidance = true;
    config.limits.upper = config.q_start.array() + 0.2;
    config.limits.lower = config.q_start.array() - 2.0;
  }
  JointVector velocity(const ControllerState& from) const {
    ControllerState state = from;
    ControllerOutput output;
    Controller(config).update({state.q_desired, {}}, config.gains, 0.0, kPeriod_s, state, output);
    return output.velocity;
  }

  test::Random random{2401};
  ControllerConfig config = test::randomController(random, 7, 3);
};

/// What there was before the stop has held a push off, and comes as fast as the law's answer does;
/// where nothing pushes, that is not asked for.
TEST(WayOut, ComesAsTheAnswerWhereTheArmLeans) {
  const ArmInItsZones arm;
  const Controller controller(arm.config);
  ControllerState state = controller.initialState();
  const JointVector whole = arm.velocity(state);
  ASSERT_GT(whole.norm(), 0.1);
  controller.restart(arm.config.gains, state);
  state.way_out_added.setZero();
  state.return_share = 0.03;  // of 2 s: a fifth of 0.3 s
  state.is_leaning = true;
  EXPECT_LT((arm.velocity(state) - 0.2 * whole).norm(), 1e-12);
  state.is_leaning = false;
  EXPECT_LT((arm.velocity(state) - whole).norm(), 1e-12);
  state.way_out_added = state.way_out_before;
  EXPECT_LT((arm.velocity(state) - 0.03 * whole).norm(), 1e-12) << "the stop's comes with beta";
}

/// An arm that has not moved since the last stop has the way out of before that one.
TEST(WayOut, IsThatOfBeforeTheFirstOfTwoStops) {
  const ArmInItsZones arm;
  const Controller controller(arm.config);
  ControllerState state = controller.initialState();
  controller.restart(arm.config.gains, state);
  const ScaledVector before = state.way_out_before;
  EXPECT_GT(before.norm(), 0.1);
  state.q_desired.array() += 0.1;
  controller.restart(arm.config.gains, state);
  EXPECT_EQ(state.way_out_before, before);
  state.return_share = 1e-6;
  controller.restart(arm.config.gains, state);
  EXPECT_NE(state.way_out_before, before);
}

/// What a retreat leads deeper into a zone has held nothing off. Of two of them the first one
/// counts.
TEST(WayOut, IsThatOfBeforeARetreat) {
  const ArmInItsZones arm;
  const Controller controller(arm.config);
  ControllerState state = controller.initialState();
  ControllerState unmoved = state;
  controller.restart(arm.config.gains, unmoved);
  ASSERT_GT(unmoved.way_out_before.norm(), 0.1);
  for (int i = 0; i < 2; ++i) {
    controller.beginRetreat(arm.config.gains, state);
    state.q_desired.array() += 0.05;
    state.retreat.has_moved = true;
  }
  controller.goOn(arm.config.gains, state);
  EXPECT_EQ(state.way_out_before, unmoved.way_out_before);
  EXPECT_FALSE(state.retreat.has_moved);
  state.return_share = 1.0;
  controller.restart(arm.config.gains, state);
  EXPECT_NE(state.way_out_before, unmoved.way_out_before) << "the retreat is over";
}

/// What a law remembers of a push that its task balanced is gone with that task; not twice.
TEST(GoneTask, TakesThePushAlongThatItBalanced) {
  for (const Variant variant : {Variant::kTaskSpace, Variant::kJointSpace, Variant::kNullTask,
                                Variant::kNullJoint, Variant::kNullSpace, Variant::kNone}) {
    test::Random random(2409);
    const ControllerConfig config = test::fullController(random, 6, variant);
    const Controller controller(config);
    const auto pushAfter = [&](double return_share) {
      ControllerState state = controller.initialState();
      state.tool_motion.emplace(tipPose(config.chain, config.q_start));
      state.contact.law.V_m_per_s = 0.1;
      state.return_share = return_share;
      controller.goOn(config.gains, state);
      return state.contact.law.V_m_per_s;
    };
    const bool is_balanced_by_task = variant != Variant::kNullSpace && variant != Variant::kNone;
    EXPECT_EQ(pushAfter(1.0), is_balanced_by_task ? 0.0 : 0.1);
    EXPECT_EQ(pushAfter(0.0), 0.1) << "it has begun anew already";
  }
}

TEST(PlacedArm, StandsWhereItIsWithinItsLimits) {
  test::Random random(2402);
  const ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  const Controller controller(config);
  ControllerState state = controller.initialState();
  state.velocity_before.setConstant(0.3);
  state.retreat.velocity_at_fault.setConstant(6, 0.3);
  state.fault = Fault::kTactileStale;
  JointVector q = JointVector::Zero(6);
  q[0] = config.limits.upper[0] + 0.1;
  q[1] = config.limits.lower[1] - 0.1;
  q[2] = 0.7;
  controller.place(q, config.gains, state);
  EXPECT_EQ(state.q_desired[0], config.limits.upper[0]);
  EXPECT_EQ(state.q_desired[1], config.limits.lower[1]);
  EXPECT_EQ(state.q_desired[2], 0.7);
  EXPECT_TRUE(state.velocity_before.isZero(0.0));
  EXPECT_TRUE(state.retreat.velocity_at_fault.isZero(0.0));
  EXPECT_EQ(state.fault, Fault::kNone);
}

/// Of what the stop added, what there was before is none where the arm leans on something.
TEST(PlacedArm, KnowsWhetherItLeansAndWhatTheStopAdded) {
  test::Random random(2403);
  const ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  const Controller controller(config);
  const JointVector q = config.limits.upper.array() - 0.1;
  ControllerState free = controller.initialState();
  const ScaledVector before = ScaledVector::Constant(0.01);
  for (const double force_N : {0.3, 0.31}) {  // F_rel is 0.3 N
    ControllerState state = controller.initialState();
    state.way_out_before = before;
    state.modules[0].contact.force_N = force_N;
    controller.place(q, config.gains, state);
    EXPECT_EQ(state.is_leaning, force_N > 0.3);
    controller.place(q, config.gains, free);
    EXPECT_LT(free.way_out_added.head(6).maxCoeff(), 0.0) << "in its zones";
    const ScaledVector all = free.way_out_added;
    EXPECT_EQ(state.way_out_added, state.is_leaning ? ScaledVector(all - before) : all);
  }
}

TEST(PlacedArm, LeansOnNothingThatZonesWouldHaveHeldOff) {
  test::Random random(2407);
  ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  config.has_joint_limit_avoidance = false;
  const Controller controller(config);
  ControllerState state = controller.initialState();
  state.modules[0].contact.force_N = 5.0;
  controller.place(config.q_start, config.gains, state);
  EXPECT_FALSE(state.is_leaning);
  EXPECT_TRUE(state.way_out_added.isZero(0.0));
}

/// Without a law nothing answers a push: a module alone changes no motion.
TEST(PlacedArm, LeansOnNothingThatNoLawAnswers) {
  test::Random random(2408);
  ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  config.force_control.reset();
  const Controller controller(config);
  ControllerState state = controller.initialState();
  state.way_out_before.setConstant(0.01);
  state.modules[0].contact.force_N = 5.0;
  ControllerState untouched = state;
  untouched.modules[0].contact.force_N = 0.0;
  controller.place(config.q_start, config.gains, state);
  controller.place(config.q_start, config.gains, untouched);
  EXPECT_FALSE(state.is_leaning);
  EXPECT_EQ(state.way_out_added, untouched.way_out_added);
}

/// The drives kept the last command, the reference its progress, and samples grew older.
TEST(MissedCycles, AreOfTheWayAndOfTheSamples) {
  test::Random random(2404);
  ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  config.tactile_modules.front().cover = CoverConfig{1.0, Vector3::Zero()};
  const Controller controller(config);
  ControllerState state = controller.initialState(JointVector::Zero(6));
  state.velocity_before = JointVector{{0.1, -0.2, 500.0, -500.0, 0.0, 0.0}};
  state.progress = 0.25;
  state.return_share = 0.1;
  state.modules[0].age_s = 0.004;
  controller.coast(4, 0.01, state);
  EXPECT_NEAR(state.q_desired[0], 0.004, 1e-15);
  EXPECT_NEAR(state.q_desired[1], -0.008, 1e-15);
  EXPECT_EQ(state.q_desired[2], config.limits.upper[2]);
  EXPECT_EQ(state.q_desired[3], config.limits.lower[3]);
  EXPECT_NEAR(state.waited_s, 0.03, 1e-15);
  EXPECT_NEAR(state.return_share, 0.1 + 0.04 / 2.0, 1e-15);
  EXPECT_NEAR(state.modules[0].age_s, 0.044, 1e-15);
  EXPECT_NEAR(state.modules[0].cover.missed_s, 0.04, 1e-15);
  controller.coast(400, 0.01, state);
  EXPECT_EQ(state.return_share, 1.0);
}

/// The drives kept their velocity meanwhile, so the next command lacks all that the ramp has got
/// to; in a retreat that is no ramp.
TEST(MissedCycles, AreOfTheRampToRest) {
  test::Random random(2406);
  ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  config.limits.max_acceleration = JointVector{{5.0, 1.0, 2.0, 2.0, 2.0, 2.0}};
  const Controller controller(config);
  ControllerState state = controller.initialState(JointVector::Zero(6));
  const JointVector velocity{{0.1, -0.2, 0.0, 0.0, 0.0, 0.0}};  // 0.2 s by the second joint
  state.velocity_before = velocity;
  ControllerState running = state;
  controller.coast(5, 0.01, running);
  EXPECT_EQ(running.velocity_before, velocity);
  state.is_stopping = true;
  ControllerState retreating = state;
  retreating.retreat.is_under_way = true;
  controller.coast(5, 0.01, retreating);
  EXPECT_EQ(retreating.velocity_before, velocity);
  controller.coast(5, 0.01, state);
  EXPECT_NEAR(state.q_desired[1], -0.01, 1e-15);
  EXPECT_EQ(state.velocity_before[0], 0.0) << "each joint by itself";
  EXPECT_NEAR(state.velocity_before[1], -0.15, 1e-15);
  controller.coast(15, 0.01, state);
  EXPECT_LT(state.velocity_before.norm(), 1e-12);
  controller.coast(15, 0.01, state);
  EXPECT_TRUE(state.velocity_before.isZero(0.0));
}

/// While an arm stops, its task's clock stands still itself.
TEST(MissedCycles, OfAStopAreNoTimeOfTheTask) {
  test::Random random(2405);
  const ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  const Controller controller(config);
  for (const bool retreats : {false, true}) {
    ControllerState state = controller.initialState();
    state.is_stopping = true;
    state.progress = 0.25;
    state.return_share = 0.1;
    state.velocity_before = JointVector::Unit(6, 0);
    state.retreat.is_under_way = retreats;
    state.retreat.row[0] = 0.5;
    controller.coast(4, 0.01, state);
    EXPECT_EQ(state.waited_s, 0.0);
    EXPECT_EQ(state.return_share, 0.1);
    EXPECT_NEAR(state.retreat.way, retreats ? 0.02 : 0.0, 1e-15);
  }
}

/// What changes between the work ahead and its cycle: the work is done anew.
TEST(PreparedState, OfAnotherStateIsNotUsed) {
  test::Random random(2406);
  ControllerConfig config = test::fullController(random, 8, Variant::kNullTask);
  config.gains.task.max_return_speed_m_per_s = config.gains.task.max_return_speed_rad_per_s = 0.01;
  config.q_start.setConstant(2.0);
  const Controller controller(config);
  const RobotInput input{config.q_start, test::touchAt(0.2, 3.0, 0.4, 1)};
  ControllerState before = controller.initialState(config.q_start.array() - 0.3);
  before.return_share = 0.03;
  before.way_out_before.setConstant(-0.05);
  const auto run = [&](const ControllerState& from, PreparedCycle prepared) {
    ControllerState state = from;
    ControllerOutput output;
    controller.update(input, config.gains, 0.3, kPeriod_s, prepared, state, output);
    return output;
  };
  PreparedCycle ahead;
  ControllerState preparing = before;
  controller.prepare(config.gains, 0.3, preparing, ahead);
  const ControllerOutput expected = run(before, ahead);
  test::expectSame(expected, run(before, {}));
  using Change = void (*)(ControllerState&);
  const Change changes[] = {[](ControllerState& s) { s.q_desired[2] += 1e-3; },
                            [](ControllerState& s) { s.contact.push.setConstant(0.005); },
                            [](ControllerState& s) { s.return_share = 0.04; },
                            [](ControllerState& s) { s.return_share = 1.0; },
                            [](ControllerState& s) { s.is_leaning = true; },
                            [](ControllerState& s) { s.waited_s = 0.02; }};
  for (const Change change : changes) {
    ControllerState changed = before;
    change(changed);
    const ControllerOutput output = run(changed, ahead);
    test::expectSame(output, run(changed, {}));
    EXPECT_NE(output.velocity, expected.velocity) << "it makes no difference: this test is blind";
    // Nor is it taken for that of a state which the same work had been done for before.
    PreparedCycle other = ahead;
    other.q_desired = before.q_desired;
    other.push = before.contact.push;
    other.return_share = before.return_share;
    other.is_leaning = before.is_leaning;
    controller.prepare(config.gains, 0.3, changed, other);
    test::expectSame(run(before, other), expected);
  }
}

}  // namespace
}  // namespace tactus
