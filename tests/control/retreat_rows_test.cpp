#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/period.h"
#include "support/rail_robot.h"
#include "support/task_kinematics.h"
#include "tactus/control/several_contacts.h"

/// How the joints leave a contact: the way out as a row beside others.
namespace tactus {
namespace {

using test::kPeriod_s;

/// An arm that a fault has stopped.
struct LeavingArm {
  explicit LeavingArm(const ControllerConfig& c) : config(c) { state.is_stopping = true; }
  void begin() {
    controller.beginRetreat(config.gains, state);
    state.retreat.is_under_way = true;
  }
  /// As it is pressed.
  void step(const TactileSample& sample) {
    controller.update({state.q_desired, {sample}}, config.gains, 0.0, kPeriod_s, state, output);
  }

  ControllerConfig config;
  Controller controller{config};
  ControllerState state = controller.initialState();
  ControllerOutput output;
};

ContactPointState pushAt(double x_m, double force_N, double angle_rad) {
  return {force_N, x_m, Vector3(0.0, std::cos(angle_rad), std::sin(angle_rad)), 0.0};
}

/// The null space does 30 times as much as the task: of a = (-1, 0) it is (-1/2, 1/2), the rest of
/// it (-1/2, -1/2).
TEST(RetreatRows, LeaveByTheNullSpaceMostly) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.gains.force.contact_threshold_N = 1.2;
  LeavingArm arm(config);
  arm.state.modules[0].hardest = pushAt(0.5, 5.0, M_PI);
  arm.begin();
  for (std::uint32_t i = 1; i < 20; ++i) {
    arm.step(test::touchAt(0.5, 5.0, M_PI, i));
    EXPECT_NEAR(arm.output.velocity[0], -2.0 * kPeriod_s * i, 1e-9);
    EXPECT_NEAR(arm.output.velocity[1], -14.5 / 15.5 * arm.output.velocity[0], 1e-9);
    EXPECT_NEAR(arm.state.retreat.way, kPeriod_s * kPeriod_s * i * (i + 1), 1e-9);
  }
  EXPECT_TRUE(arm.state.retreat.has_moved);
  arm.controller.goOn(config.gains, arm.state);
  EXPECT_EQ(arm.state.return_share, 0.0) << "it comes back to its path gently";
}

/// An arm that goes slowly without a module leaves contacts as fast as ever.
TEST(RetreatRows, AreAsFastWhileAModuleIsLost) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.gains.force.contact_threshold_N = 1.2;
  config.limits.max_velocity.setConstant(1.0);
  config.module_loss = ModuleLossConfig{0.3};
  for (const double share : {1.0, 0.3}) {
    LeavingArm arm(config);
    arm.state.speed_share = share;
    arm.state.modules[0].unproven_s = share < 1.0 ? 1.0 : 0.0;
    arm.state.modules[0].hardest = pushAt(0.5, 5.0, M_PI);
    arm.begin();
    arm.step(test::touchAt(0.5, 5.0, M_PI, 1));
    arm.state.retreat.speed = 0.9;
    arm.step(test::touchAt(0.5, 5.0, M_PI, 2));
    EXPECT_EQ(arm.output.speed_share, share);
    EXPECT_NEAR(arm.output.velocity[0], -0.9 - 2.0 * kPeriod_s, 1e-9);
  }
}

/// Along the push as it was, by differences of the point's position alone, though the link turns.
TEST(RetreatRows, MoveThePointAlongItsPush) {
  test::Random random(2501);
  for (int run = 0; run < 50; ++run) {
    const int joints = random.integer(4, 9);
    ControllerConfig config = test::randomController(random, joints, random.integer(1, 3));
    config.weights = test::randomWeights(random, joints);
    config.force_control.emplace();
    config.gains.force.contact_threshold_N = 1.2;
    LeavingArm arm(config);
    const double x_m = random.uniform(0.05, 0.35), angle_rad = random.uniform(-3.0, 3.0);
    arm.state.modules[0].hardest = pushAt(x_m, 20.0, angle_rad);
    arm.begin();
    const auto pose = [&](const JointVector& q) {
      ChainPose chain_pose;
      config.chain.computePose(q, chain_pose);
      return framePose(chain_pose, config.tactile_modules.front().link);
    };
    const auto point = [&](const JointVector& q) {
      const Pose X = pose(q);
      return Vector3(X.p_AB + x_m * X.R_AB.col(0));
    };
    const Vector3 F_Base =
        pose(config.q_start).R_AB * Vector3(0.0, std::cos(angle_rad), std::sin(angle_rad));
    for (std::uint32_t i = 1; i < 100; ++i) {
      const JointVector q = arm.state.q_desired;
      arm.step(test::touchAt(x_m, 20.0, 0.0, i));  // from another side by now
      const JointVector& v = arm.output.velocity;
      const double h = 1e-6 / (1e-3 + v.norm());
      const double speed = (point(q + h * v) - point(q - h * v)).dot(F_Base) / (2.0 * h);
      ASSERT_NEAR(speed, 2.0 * kPeriod_s * i, 1e-6 * (1.0 + v.norm())) << run << " " << i;
    }
  }
}

/// Without samples, as far as what was known when it began says: also where it moved outwards then.
TEST(RetreatRows, LeaveWithoutSamplesByWhatWasKnown) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.gains.force.contact_threshold_N = 1.2;
  config.gains.force.assumed_stiffness_N_per_m = 8000.0;
  LeavingArm arm(config);
  arm.state.modules[0].hardest = pushAt(0.5, 5.0, M_PI);
  arm.state.velocity_before << -0.1, 0.0;
  arm.begin();
  const double expected_m = 5.0 / 1000.0 + 0.1 * arm.state.retreat.untold_s + 0.02;
  ASSERT_LT(expected_m, 0.09);
  for (int i = 0; i < 1000; ++i) arm.step({});
  EXPECT_TRUE(arm.state.retreat.is_over);
  EXPECT_NEAR(arm.state.retreat.way_to, expected_m, 1e-12);
  EXPECT_NEAR(arm.state.retreat.way, expected_m, 1e-3);
}

/// Joints come to their limits on the way out as slowly as ever.
TEST(RetreatRows, KeepJointsOffTheirLimits) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.limits.lower[0] = -0.02;
  LeavingArm arm(config);
  arm.state.modules[0].hardest = pushAt(0.5, 5.0, M_PI);
  arm.begin();
  arm.step(test::touchAt(0.5, 5.0, M_PI, 1));
  arm.state.retreat.speed = 0.9;
  const double left_m = arm.state.q_desired[0] - config.limits.lower[0];
  arm.step(test::touchAt(0.5, 5.0, M_PI, 2));
  EXPECT_NEAR(-arm.output.velocity[0], 5.0 * left_m, 0.1 * left_m);
}

TEST(RetreatRows, OfAnArmThatStoodMoveNothing) {
  LeavingArm arm(test::railController(Variant::kNullSpace));
  arm.begin();
  for (std::uint32_t i = 1; i < 5; ++i) arm.step(test::touchAt(0.5, 0.0, 0.0, i));
  EXPECT_TRUE(arm.output.velocity.isZero(0.0));
  EXPECT_FALSE(arm.state.retreat.has_moved) << "it stands on its path";
}

/// What is felt on the way back is left like any other contact; what is left stays that one.
TEST(RetreatRows, TurnFromTheWayBackToAContact) {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.gains.force.contact_threshold_N = 1.2;
  LeavingArm arm(config);
  arm.state.velocity_before << 0.3, 0.0;
  arm.begin();
  arm.step(test::touchAt(0.5, 0.0, 0.0, 1));
  EXPECT_EQ(arm.output.velocity, JointVector(JointVector{{-0.3, 0.0}}));
  EXPECT_NEAR(arm.state.retreat.way, kPeriod_s, 1e-12) << "seconds";
  for (const double force_N : {5.0, 9.0}) {
    arm.step(test::touchAt(0.1 * force_N, force_N, 0.0, arm.state.modules[0].sequence + 1));
    if (force_N == 5.0) {
      EXPECT_NEAR(arm.state.retreat.way, 2.0 * kPeriod_s * kPeriod_s, 1e-12) << "metres again";
    }
    EXPECT_EQ(arm.state.retreat.push.position_m, 0.5);
    EXPECT_GT(arm.output.velocity[0], 0.0) << "its push is towards +y";
  }
}

/// Squeezed from both sides, as if it had asked for that speed by itself.
TEST(RetreatRows, ShareWithOtherContactsAsAnyRow) {
  ControllerConfig config = test::railController(Variant::kNullLimit);
  config.gains.force.contact_threshold_N = 1.2;
  config.gains.force.activation_force_N = 3.8;
  config.gains.force.assumed_stiffness_N_per_m = 1000.0;
  config.tactile_modules.push_back(config.tactile_modules.front());
  config.weights << 0.5, 2.0;
  LeavingArm arm(config);
  arm.state.modules[0].hardest = pushAt(0.5, 5.0, M_PI);
  ApproachLimitState& other = arm.state.several.modules[1].approach;
  other.memory_N_per_m = 500.0;  // half forgotten
  other.estimator.stiffness_N_per_m = 1000.0;
  other.smoother.contact = pushAt(0.5, 0.0, 0.0);
  arm.begin();
  arm.step(test::touchAt(0.5, 5.0, M_PI, 1));
  arm.state.retreat.speed = 0.5;  // faster than the other may be met
  arm.step(test::touchAt(0.5, 5.0, M_PI, 2));
  const ScaledVector inv_sqrt =
      scaled(JointVector(config.weights.cwiseSqrt().cwiseInverse()), ScaledVector::Ones());
  TaskKinematics kinematics;
  test::computeTaskKinematics(config, config.q_start, inv_sqrt, kinematics);
  SpeedRows rows;
  SpeedRow& own = rows.row[rows.size++];
  own.a_scaled = -inv_sqrt[0] * ScaledVector::Unit(0);
  own.a_task = kinematics.pseudoinverse.project(own.a_scaled);
  own.v_max_m_per_s = -0.5 - 2.0 * kPeriod_s;
  own.damping_N_s_per_m = config.gains.force.time_constant_s * 1000.0 / 8.0;
  own.presence = 1.0;
  SeveralContacts(config, inv_sqrt)
      .addRows(config.gains.force, kinematics, 0, arm.state.several, rows);
  ASSERT_EQ(rows.size, 2);
  EXPECT_NEAR(rows.row[1].presence, 0.5, 0.01);
  Motion motion;
  motion.y.setZero();
  motion.v_scaled.setZero();
  RowProblem(rows, 1).keep(motion);
  const ScaledVector expected =
      inv_sqrt.cwiseProduct(motion.v_scaled + kinematics.pseudoinverse.expand(motion.y));
  EXPECT_GT(-expected[0], 0.1);
  EXPECT_LT(-expected[0], 0.4) << "each of both gives way";
  EXPECT_LT((arm.output.velocity - expected.head(2)).norm(), 1e-12);
}

}  // namespace
}  // namespace tactus
