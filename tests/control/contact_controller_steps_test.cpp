#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/one_contact_run.h"
#include "tactus/control/acceleration_law.h"

/// Where a law takes its contact to be, what it learns of it and what it tells at rest, on a rail.
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

/// Until something is felt.
TEST(ContactPlace, IsTheMiddleOfTheModuleAtFirst) {
  for (const double length_m : {0.2, 0.7}) {
    ControllerConfig config = oneContactRail(0.1);
    config.tactile_modules.front().length_m = length_m;
    EXPECT_EQ(OneContactRun(config).state.contact.approach.smoother.contact.position_m,
              0.5 * length_m);
    config.force_control->variant = Variant::kJointSpace;
    EXPECT_EQ(OneContactRun(config).state.contact.joint_space_transition.contact.position_m,
              0.5 * length_m);
  }
}

/// Below the threshold the ringing of the module's filter says nothing of where a contact was: with
/// a return speed it stays, once there was one.
TEST(ContactPlace, IsKeptBelowTheThresholdWithAReturnSpeed) {
  for (const bool has_return_speed : {false, true}) {
    ControllerConfig config = test::railController(Variant::kNullSpace);
    config.gains.force.contact_threshold_N = kOneThreshold_N;
    if (has_return_speed) config.gains.task.max_return_speed_m_per_s = 0.5;
    OneContactRun run(config);
    const ContactPointState& contact = run.state.contact.contact;
    const auto expect = [&](double force_N, double position_m, double angle_rad) {
      const Vector3 direction(0.0, -std::cos(angle_rad), -std::sin(angle_rad));
      EXPECT_NEAR(contact.force_N, force_N, 1e-12);
      EXPECT_NEAR(contact.position_m, position_m, 1e-12);
      EXPECT_LT((contact.direction - direction).norm(), 1e-12);
    };
    run.press(0.5, 0.2, 0.3);
    expect(0.5, 0.2, 0.3);  // nothing was lost yet
    run.press(3.0, 0.5, 0.0);
    expect(3.0, 0.5, 0.0);
    run.press(0.5, 0.3, 1.2);
    has_return_speed ? expect(0.5, 0.5, 0.0) : expect(0.5, 0.3, 1.2);
    run.press(kOneThreshold_N, 0.3, 0.0);
    has_return_speed ? expect(kOneThreshold_N, 0.5, 0.0) : expect(kOneThreshold_N, 0.3, 0.0);
    run.press(1.5, 0.3, 1.2);
    expect(1.5, 0.3, 1.2);
  }
}

/// By force over way, where the assumed stiffness is seven times as large.
TEST(ContactStiffness, IsLearntWhileTheArmPresses) {
  for (const Variant variant : {Variant::kNullTask, Variant::kNullLimit}) {
    ControllerConfig config = oneContactRail(0.05);
    config.force_control->variant = variant;
    config.force_control->has_estimator = true;
    config.gains.force.assumed_stiffness_N_per_m = 7.0 * kOneC_N_per_m;
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    OneContactRun run(config);
    const test::RailWorld world{kOneC_N_per_m, 0.0};
    double force_N = 0.0;
    for (int i = 0; i < 5000 && force_N < 2.8; ++i) {
      force_N = world.force_N(run.state.q_desired);
      run.press(force_N);
    }
    ASSERT_GE(force_N, 2.8);
    EXPECT_GT(run.output.contact.stiffness_N_per_m, 0.95 * kOneC_N_per_m);
    EXPECT_LT(run.output.contact.stiffness_N_per_m, 3.0 * kOneC_N_per_m);
    EXPECT_GT(run.output.contact.stiffness_raw_N_per_m, 0.95 * kOneC_N_per_m);
    EXPECT_LT(run.output.contact.stiffness_raw_N_per_m, 3.0 * kOneC_N_per_m);
  }
}

/// And what pulls the tool in joint space waits.
TEST(ContactThatIsHeld, IsStillToldOf) {
  for (const Variant variant : {Variant::kNullSpace, Variant::kJointSpace}) {
    ControllerConfig config = oneContactRail(0.1);
    config.force_control->variant = variant;
    OneContactRun run(config);
    run.pressFor(300, 3.0);
    const double gamma = run.output.contact.gamma;
    EXPECT_GT(gamma, 0.9);
    run.state.is_stopping = true;
    run.press(3.0);
    EXPECT_EQ(run.output.contact.gamma, gamma);
    EXPECT_NEAR(run.output.contact.x_dot_eff_m_per_s, -0.05, 1e-12);
    EXPECT_EQ(run.state.contact.joint_space_transition.kappa, 0.0);
  }
}

/// The last motion out of a contact that is gone does not go on for ever.
TEST(ContactIntegral, FadesWhereTheContactIsGone) {
  OneContactRun run(oneContactRail(0.0));
  run.pressFor(50, 3.0);
  const double held_m_per_s = run.state.contact.law.V_m_per_s;
  ASSERT_GT(held_m_per_s, 0.0);
  run.pressFor(1000, 0.0);
  EXPECT_LT(run.state.contact.law.V_m_per_s, 0.4 * held_m_per_s);
}

/// An offset of the sensor looks like a contact that is about to be lost.
TEST(ContactIntegral, FollowsNoOffsetBeyondWhereTheContactWas) {
  OneContactRun run(oneContactRail(0.0));
  run.pressFor(50, 3.0);
  run.press(1.3);
  const double lost_m = run.state.q_desired[0];
  run.pressFor(60000, 0.7);
  EXPECT_LT(std::abs(run.state.q_desired[0] - lost_m),
            1.2 * run.config.gains.force.transition.distance_m);
}

/// Halfway between release and threshold half of the integral still pushes.
TEST(ContactIntegral, OfJointSpaceIsUsedByHalfHalfway) {
  ControllerConfig config = oneContactRail(0.0);
  config.force_control->variant = Variant::kJointSpace;
  OneContactRun run(config);
  run.press(3.0);
  run.state.contact.law.V_m_per_s = 0.1;
  run.press(0.75);
  EXPECT_NEAR(run.output.contact.u_j, -0.05, 1e-3);
}

/// Only where there is a second space may the law move the tool by itself.
TEST(ContactPush, IsNoneOfALawThatLimits) {
  ControllerConfig config = oneContactRail(0.5);
  config.gains.task.max_return_speed_m_per_s = 0.5;
  config.gains.force.max_null_speed_m_per_s = 1e-12;
  OneContactRun run(config);
  run.pressFor(20, 10.0);
  EXPECT_LT(run.output.contact.u_t, 0.0);
  EXPECT_FALSE(run.state.contact.has_push);
  EXPECT_EQ(run.state.contact.push.size(), 0);
}

/// The joint would take the retreat once more, and the approach with it.
TEST(ContactRows, KeepJointsAsSoonAsTheirLimitsCutARetreat) {
  ControllerConfig config = oneContactRail(0.0);
  config.limits.lower[0] = -0.002;
  for (const double cut_m_per_s : {0.0, 0.01, 2.0}) {
    OneContactRun run(config);
    run.press(4.0);
    run.state.contact.keeps_joints = false;
    run.state.contact.cut_m_per_s = cut_m_per_s;
    run.press(4.0);
    EXPECT_EQ(run.state.contact.keeps_joints, cut_m_per_s > 0.0) << cut_m_per_s;
  }
}

/// At the acceleration level the approach is brought to its limit by k_v, and the force to rest at
/// F_act + F_th, with rows and without.
TEST(ContactRows, EaseTheApproachAtTheAccelerationLevel) {
  for (const bool has_wall : {false, true}) {
    ControllerConfig config = oneContactRail(0.1);
    config.force_control->level = ControlLevel::kAcceleration;
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    if (has_wall) addFarWall(config);
    OneContactRun run(config);
    const test::RailWorld world{kOneC_N_per_m, 0.002};
    const double share = velocityShare(config.gains.force, kPeriod_s);
    int limited = 0;
    for (int i = 0; i < 3000; ++i) {
      const double before_m_per_s =
          run.state.velocity_before.size() > 0 ? run.state.velocity_before[0] : 0.0;
      run.press(world.force_N(run.state.q_desired));
      if (run.output.contact.u_t >= 0.0) continue;
      ++limited;
      const ApproachLimitState& approach = run.state.contact.approach;
      const double m = approach.memory_N_per_m;
      const double F_N =
          std::max(0.0, run.output.contact.force_contact_N + m * approach.way_ahead_m);
      const double v_max = (kOneAct_N - F_N) / (kOneT_s * m) - approach.obstacle.v_m_per_s;
      ASSERT_NEAR(run.output.velocity[0], before_m_per_s + share * (v_max - before_m_per_s), 1e-6)
          << i << " " << has_wall;
    }
    EXPECT_GT(limited, 500);
    EXPECT_NEAR(world.force_N(run.state.q_desired), kOneAct_N + kOneThreshold_N, 0.05);
  }
}

/// Nor does it ever carry on towards the obstacle what the law is about to stop.
TEST(ContactRows, NeverPushTowardsAContactAtTheAccelerationLevel) {
  int eased = 0;
  for (double before_m_per_s = 0.05; before_m_per_s < 1.0; before_m_per_s += 0.01) {
    ControllerConfig config = oneContactRail(0.1);
    config.force_control->level = ControlLevel::kAcceleration;
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    config.gains.force.time_constant_s = 0.03;
    config.gains.force.assumed_stiffness_N_per_m = 300.0;
    OneContactRun run(config);
    run.press(kOneThreshold_N + 0.1);
    run.state.velocity_before.setConstant(2, before_m_per_s);
    run.press(kOneThreshold_N + 0.9);
    EXPECT_LE(run.output.contact.u_t, 0.0) << before_m_per_s;
    eased += run.state.contact.approach.is_limiting && run.output.contact.u_t == 0.0 ? 1 : 0;
  }
  EXPECT_GT(eased, 0);
}

}  // namespace
}  // namespace tactus
