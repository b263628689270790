#include "tactus/control/contact_controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/one_contact_run.h"

/// What the answer to one contact tells and remembers, on a rail.
namespace tactus {
namespace {

using test::addFarWall;
using test::kOneAct_N;
using test::kOneC_N_per_m;
using test::kOneT_s;
using test::kOneThreshold_N;
using test::kPeriod_s;
using test::oneContactRail;
using test::OneContactRun;

enum class RowsFor { kFriction, kWall, kJoints };

/// dF/dt = -(F - F_act - F_th) / T, and what the tool loses of its speed is what u_t says.
TEST(ContactRows, LimitTheToolByWhatTheyTell) {
  constexpr double kSpeed_m_per_s = 10.0;
  for (const RowsFor rows : {RowsFor::kFriction, RowsFor::kWall, RowsFor::kJoints}) {
    const double mu = rows == RowsFor::kFriction ? 0.5 : 0.0;
    ControllerConfig config = oneContactRail(kSpeed_m_per_s, mu);
    if (rows == RowsFor::kWall) addFarWall(config);
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    OneContactRun run(config);
    const test::RailWorld world{kOneC_N_per_m, -0.002};
    for (int i = 0; i < 800; ++i) {
      const double before_N = world.force_N(run.state.q_desired);
      run.state.contact.keeps_joints = rows == RowsFor::kJoints;  // in the last cycle
      run.press(before_N);
      if (i < 20) continue;
      const double F_dot = -(before_N - kOneAct_N - kOneThreshold_N) / kOneT_s;
      ASSERT_NEAR(world.force_N(run.state.q_desired) - before_N, kPeriod_s * F_dot,
                  kPeriod_s * 0.01 * std::abs(F_dot) + 1e-5)
          << static_cast<int>(rows) << " " << i;
      ASSERT_LT(run.output.contact.u_t, 0.0);
      ASSERT_NEAR(run.output.velocity.sum(),
                  kSpeed_m_per_s + run.output.contact.u_t / std::hypot(1.0, mu), 1e-9);
      ASSERT_TRUE(run.state.contact.approach.is_limiting);
    }
  }
}

/// By which estimators know what the arm was kept from: only as long as it is.
TEST(ContactRows, LimitNoLongerThanTheyHaveTo) {
  for (const RowsFor rows : {RowsFor::kFriction, RowsFor::kWall}) {
    ControllerConfig config = oneContactRail(0.0, rows == RowsFor::kFriction ? 0.5 : 0.0);
    if (rows == RowsFor::kWall) addFarWall(config);
    config.gains.force.max_null_speed_m_per_s = 1e-12;  // so that the tool has to go back
    OneContactRun run(config);
    run.pressFor(5, 4.0 * kOneAct_N);
    EXPECT_TRUE(run.state.contact.approach.is_limiting);
    run.pressFor(5, 0.5 * kOneAct_N);
    EXPECT_FALSE(run.state.contact.approach.is_limiting) << static_cast<int>(rows);
  }
}

/// By so much the law's integral must not grow.
TEST(ContactRows, TellWhatJointsTookOfTheRetreat) {
  const auto pressed = [](double left_m, int joint) {
    ControllerConfig config = oneContactRail(0.0, 0.5);
    config.limits.lower[0] = joint == 0 ? -left_m : -9.0;
    config.limits.upper[1] = joint == 1 ? left_m : 9.0;
    OneContactRun run(config);
    run.press(4.0);
    EXPECT_EQ(run.state.contact.keeps_joints, left_m < 0.25);
    return run;
  };
  for (const int joint : {0, 1}) {
    const OneContactRun free = pressed(1.0, joint), near = pressed(0.002, joint);
    EXPECT_EQ(free.state.contact.cut_by_rows_m_per_s, 0.0);
    const double cut_m_per_s = near.output.velocity[0] - free.output.velocity[0];
    EXPECT_GT(cut_m_per_s, 0.01);
    EXPECT_NEAR(near.state.contact.cut_by_rows_m_per_s, cut_m_per_s, 1e-12) << joint;
  }
}

/// As the contact is forgotten, what keeps joints off their limits beside it goes without a step,
/// and is gone with it.
TEST(ContactRows, OfJointsFadeWithTheMemory) {
  constexpr double kLeft_m = 0.1;
  for (const double share : {1.0, 0.5, 0.25}) {
    ControllerConfig config = oneContactRail(10.0, 0.5);
    config.limits.upper[1] = kLeft_m;
    OneContactRun run(config);
    run.press(4.0);
    run.state.q_desired.setZero();
    run.state.contact.approach.memory_N_per_m = share * kOneC_N_per_m;
    run.press(0.0);
    const double left = run.state.contact.approach.memory_N_per_m / kOneC_N_per_m;
    EXPECT_NEAR(run.output.velocity[1], 5.0 * kLeft_m / left, 1e-3) << share;
    EXPECT_TRUE(run.state.contact.keeps_joints);
    run.state.contact.approach.memory_N_per_m = 1e-6;
    run.press(0.0);
    EXPECT_FALSE(run.state.contact.keeps_joints);
    EXPECT_EQ(run.state.contact.cut_by_rows_m_per_s, 0.0);
  }
}

/// Nothing that was felt has to be left: joints keep to their limits by other means.
TEST(ContactRows, AreNoneBeforeAContact) {
  ControllerConfig config = oneContactRail(0.1, 0.5);
  config.limits.lower[0] = 0.0;  // it stands there
  OneContactRun law(config);
  config.force_control.reset();
  OneContactRun none(config);
  for (int i = 0; i < 10; ++i) {
    law.press(0.0);
    none.press(0.0);
    ASSERT_EQ(law.output.velocity, none.output.velocity) << i;
    ASSERT_EQ(law.output.fault, Fault::kNone);
    ASSERT_EQ(law.output.contact.u_t, 0.0);
    ASSERT_EQ(law.state.contact.cut_by_rows_m_per_s, 0.0);
    ASSERT_FALSE(law.state.contact.keeps_joints);
  }
}

/// What was learnt of a contact is of use as long as it is felt, and not after.
TEST(ContactMemory, KeepsAStiffnessAboveTheReleaseForceAlone) {
  for (const double force_N : {0.31, 0.3, 0.29}) {
    ControllerConfig config = oneContactRail(0.0);
    config.force_control->has_estimator = true;
    config.gains.force.max_null_speed_m_per_s = 1e-12;  // it stays there
    config.gains.force.transition.release_force_N = 0.3;
    OneContactRun run(config);
    run.pressFor(10, 3.0);
    run.state.contact.approach.estimator.stiffness_N_per_m = 50.0 * kOneC_N_per_m;
    run.pressFor(8000, force_N);
    EXPECT_NEAR(run.output.contact.stiffness_N_per_m, (force_N > 0.3 ? 50.0 : 1.0) * kOneC_N_per_m,
                0.02 * 50.0 * kOneC_N_per_m);
  }
}

TEST(ContactMemory, LearnsOfNewSamplesAlone) {
  ControllerConfig config = oneContactRail(0.1);
  config.force_control->has_estimator = true;
  OneContactRun run(config);
  for (int i = 1; i < 5; ++i) run.press(i);
  const ApproachLimitState& approach = run.state.contact.approach;
  EXPECT_TRUE(approach.smoother.contact.isNew());
  const double before_m = approach.estimator.x_m;
  const TactileSample old = test::touchAt(0.5, -4.0, 0.0, run.state.modules[0].sequence);
  run.controller.update({run.state.q_desired, {old}}, run.config.gains, 0.0, kPeriod_s, run.state,
                        run.output);
  EXPECT_FALSE(approach.smoother.contact.isNew());
  EXPECT_EQ(approach.estimator.x_m, before_m);
}

/// Below the threshold a law that limits lets a contact come nearer, as it else would let it go:
/// without a leak of what it has learnt, as long as the arm is where it felt the contact.
TEST(ContactIntegral, GoesBothWaysAboutTheThreshold) {
  OneContactRun run(oneContactRail(0.0));
  run.pressFor(50, 3.0);
  const double& V_m_per_s = run.state.contact.law.V_m_per_s;
  double before_m_per_s = V_m_per_s;
  run.press(kOneThreshold_N + 0.4);
  const double more_m_per_s = V_m_per_s - before_m_per_s;
  before_m_per_s = V_m_per_s;
  run.press(kOneThreshold_N - 0.4);
  EXPECT_GT(more_m_per_s, 0.0);
  EXPECT_NEAR(V_m_per_s - before_m_per_s, -more_m_per_s, 1e-3 * more_m_per_s);
}

/// How far a contact is engaged is of the feedforward alone: what presses counts as it is.
TEST(ContactIntegral, TakesASmallForceForWhatItIs) {
  double at_once = 0.0;
  for (const double engage_N : {0.0, 2.0}) {
    ControllerConfig config = oneContactRail(0.0);
    config.gains.force.transition.engage_force_N = engage_N;
    OneContactRun run(config);
    run.press(kOneThreshold_N + 0.5);
    EXPECT_EQ(run.output.contact.gamma, engage_N > 0.0 ? 0.25 : 1.0);
    if (engage_N == 0.0) at_once = run.output.contact.u_n;
    EXPECT_LT(run.output.contact.u_n, 0.0);
    EXPECT_NEAR(run.output.contact.u_n, at_once, 1e-12);
  }
}

/// An arm that is held remembers what it holds against, and forgets it once nothing is felt.
TEST(ContactIntegral, OfAHeldArmFadesWhereNothingIsFelt) {
  for (const Variant variant : {Variant::kNullSpace, Variant::kJointSpace, Variant::kNullLimit}) {
    ControllerConfig config = oneContactRail(0.0);
    config.force_control->variant = variant;
    OneContactRun run(config);
    run.pressFor(50, 3.0);
    const double held_m_per_s = run.state.contact.law.V_m_per_s;
    EXPECT_GT(held_m_per_s, 0.0);
    run.state.is_stopping = true;
    run.pressFor(500, 3.0);
    EXPECT_EQ(run.state.contact.law.V_m_per_s, held_m_per_s);
    run.pressFor(100, kOneThreshold_N + 0.5);
    EXPECT_EQ(run.state.contact.law.V_m_per_s, held_m_per_s);
    run.pressFor(500, 0.0);
    const double T_s = config.gains.force.transition.max_time_constant_s;
    EXPECT_NEAR(run.state.contact.law.V_m_per_s, held_m_per_s * std::exp(-0.5 / T_s),
                1e-6 * held_m_per_s);
  }
}

/// It holds where it still feels something, or nothing, whether it got there by a retreat or not.
TEST(ContactThatIsHeld, IsOneWhenTheArmGoesOnAfterARetreatToo) {
  for (const Variant variant : {Variant::kNullSpace, Variant::kJointSpace, Variant::kNullLimit}) {
    for (const bool has_retreated : {false, true}) {
      for (const double force_N : {0.2, 0.3, 0.8}) {  // of 0.3 N, and below the threshold
        ControllerConfig config = oneContactRail(0.1);
        config.force_control->variant = variant;
        OneContactRun run(config);
        run.state.is_stopping = true;
        run.pressFor(100, force_N);
        run.state.retreat.has_moved = has_retreated;
        run.controller.goOn(config.gains, run.state);
        run.state.is_stopping = false;
        run.press(force_N);
        EXPECT_NEAR(run.output.contact.gamma, force_N > 0.3 ? 1.0 : 0.0, 0.01)
            << static_cast<int>(variant) << " " << has_retreated << " " << force_N;
        if (variant != Variant::kJointSpace || force_N <= 0.3) continue;
        run.pressFor(100, force_N);
        EXPECT_NEAR(run.output.contact.gamma, 1.0, 0.01) << "it is not left";
      }
    }
  }
}

/// By which a return speed knows how fast the law moves the tool itself.
TEST(ContactPush, IsWhatTheSecondSpaceDoesToTheTool) {
  for (const Variant variant : {Variant::kNullTask, Variant::kNullJoint}) {
    ControllerConfig config = test::railController(variant);
    config.gains.task.max_return_speed_m_per_s = 0.5;
    OneContactRun run(config);
    for (int i = 0; i < 20; ++i) {
      run.press(10.0);
      EXPECT_LT(run.state.contact.push[0], -1e-3);
      EXPECT_NEAR(run.state.contact.push[0], run.output.velocity.sum(), 1e-12);
    }
    EXPECT_TRUE(run.state.contact.has_push);
    run.state.is_stopping = true;
    run.press(10.0);
    EXPECT_EQ(run.state.contact.push[0], 0.0);
    EXPECT_FALSE(run.state.contact.has_push);
  }
}

/// A tool that is off its path by so much, in a contact at +y that is felt below the threshold.
constexpr double kAway_m = 0.1;
struct PulledRail {
  explicit PulledRail(double away_m) : tool_m(-away_m) {
    config.gains.force.contact_threshold_N = kOneThreshold_N;
    config.gains.task.drift_gain_per_s = 5.0;
    config.gains.force.pull_gain_per_s = 3.0;
  }
  ControllerOutput output(double return_share = 1.0) const {
    OneContactRun run(config);
    run.state.q_desired[1] = tool_m;
    run.state.return_share = return_share;
    JointSpaceTransitionState& transition = run.state.contact.joint_space_transition;
    transition.gamma = transition.kappa = 1.0;
    transition.touching = true;
    run.press(1.0);
    return run.output;
  }
  /// The carriage that is touched comes no nearer; what its share would be is not made up for.
  void expectSpeed(double m_per_s, double return_share = 1.0) const {
    const JointVector v = output(return_share).velocity;
    EXPECT_NEAR(v[0], std::min(0.0, 0.5 * m_per_s), 1e-9);
    EXPECT_NEAR(v[1], 0.5 * m_per_s, 1e-9);
  }

  double tool_m;
  ControllerConfig config = test::railController(Variant::kJointSpace);
};

/// (2) and the pull of joint space together keep to the return speed.
TEST(JointSpacePull, IsWhatTheReturnSpeedLeaves) {
  for (const double side : {1.0, -1.0}) {
    PulledRail rail(side * kAway_m);
    rail.expectSpeed(side * 8.0 * kAway_m);
    EXPECT_NEAR(rail.output().contact.x_dot_eff_m_per_s, -0.5 * side * 8.0 * kAway_m, 1e-9);
    for (const double cap_per_s : {9.0, 7.0, 4.0}) {
      rail.config.gains.task.max_return_speed_m_per_s = cap_per_s * kAway_m;
      rail.expectSpeed(side * std::min(8.0, cap_per_s) * kAway_m);
    }
  }
}

/// The correction of (2) is 5, the pull at most 3.
TEST(JointSpacePull, IsLessWhereTheArmReturnsOrNearsItsLimits) {
  PulledRail rail(-kAway_m);
  rail.expectSpeed(-0.25 * 8.0 * kAway_m, 0.25);
  rail.config.gains.force.max_null_speed_m_per_s = 0.5 * kAway_m;  // of each carriage
  rail.expectSpeed(-(5.0 + 1.0) * kAway_m);
  rail.config.gains.force.max_null_speed_m_per_s = 10.0;
  rail.config.has_joint_limit_avoidance = true;
  rail.config.gains.joint_limit_avoidance.gain = 0.0;
  rail.config.gains.joint_limit_avoidance.active_fraction = 0.5;
  rail.config.limits.lower.setConstant(-4.0 * kAway_m / 3.0);
  rail.config.limits.upper.setConstant(4.0 * kAway_m / 3.0);  // halfway into its zone
  rail.expectSpeed(-(5.0 + 3.0 * 0.75) * kAway_m);
}

}  // namespace
}  // namespace tactus
