#include "tactus/control/acceleration_law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/rail_robot.h"
#include "support/task_kinematics.h"
#include "tactus/math/filter.h"

/// The terms of the header one by one, on a rail: a = (-1, 0), of which half is in the null space.
/// T = 0.1 s, d = 0.5, c = 1000 N/m, k_v = 100/s.
namespace tactus {
namespace {

constexpr double kTerm_s = 0.001;
constexpr double kTermPerN = kTerm_s / (0.1 * 0.1 * 1000.0);

struct AccelerationTerms {
  explicit AccelerationTerms(Variant variant = Variant::kNullSpace) : law(config(variant)) {
    gains.time_constant_s = 0.1;
    gains.damping = 0.5;
    gains.velocity_gain_per_s = 100.0;
    gains.activation_force_N = 3.0;
    input.stiffness_N_per_m = 1000.0;
    input.integral_decay = 1.0;
    test::computeTaskKinematics(test::railChain(), JointVector::Zero(2), {1}, ScaledVector::Ones(),
                                kinematics);
    kinematics.y_eff.setZero();
    computeContactSpace(kinematics.pseudoinverse, -ScaledVector::Unit(0), ScaledVector::Ones(),
                        kinematics.y_eff, space);
    free.w_dd.setZero();
    free.cost_change.setZero();
    before(0.0, 0.0);
    motion.y.setZero();
    motion.v_scaled.setZero();
  }
  static ForceControlConfig config(Variant variant) {
    ForceControlConfig config;
    config.variant = variant;
    return config;
  }
  /// The previous command: of the tool, and of the contact by the null space, away from it.
  void before(double tool_m_per_s, double retreat_m_per_s) {
    free.v_before = scaled(
        JointVector{{0.5 * tool_m_per_s - retreat_m_per_s, 0.5 * tool_m_per_s + retreat_m_per_s}},
        ScaledVector::Ones());
    free.y_before = kinematics.pseudoinverse.project(free.v_before);
  }
  void update() {
    motion.y.setZero();
    motion.v_scaled = cost;
    law.update(gains, input, curvature, free, kinematics, space, kTerm_s, state, motion, u);
  }
  /// s_n and s_t
  double nullSpeed() {
    update();
    return -0.5 * u.u_n;
  }
  double taskSpeed() {
    update();
    return -0.5 * u.u_t;
  }
  /// a^T q_dot of all
  double retreat() const {
    const ScaledVector v = motion.v_scaled + kinematics.pseudoinverse.expand(motion.y);
    return -v[0];
  }

  AccelerationLaw law;
  ForceGains gains;
  ControlLawInput input;
  ContactSpace space;
  TaskKinematics kinematics;
  FreeAcceleration free;
  ControlLawState state;
  Motion motion;
  ControlLawOutput u;
  double curvature = 0.0;
  ScaledVector cost = ScaledVector::Zero();  ///< what the free null space does
  double share = lagShare(kTerm_s, 0.01);
  double damped = lagShare(kTerm_s, 0.1);
};

TEST(AccelerationTerms, ForceAndDampingInContact) {
  AccelerationTerms it;
  it.input.F_p_N = 2.0;
  EXPECT_NEAR(it.nullSpeed(), 2.0 * kTermPerN, 1e-12);
  it.before(0.0, 1e-4);
  EXPECT_NEAR(it.nullSpeed(), 1e-4 + 2.0 * kTermPerN - it.damped * 1e-4, 1e-12);
  it.before(0.002, 0.0);  // the tool takes the contact point with it, by half
  EXPECT_NEAR(it.nullSpeed(), 2.0 * kTermPerN + it.damped * 1e-3, 1e-12);
}

/// gamma = 1/2: what the free motion gains towards the contact is half made up for, be it by the
/// task or as the point moves on a curve.
TEST(AccelerationTerms, FeedforwardOfWhatTheFreeMotionGains) {
  AccelerationTerms it;
  it.space.x_dot_eff_m_per_s = -0.2;
  it.input.x_dot_ff_m_per_s = -0.1;
  it.input.F_p_N = 2.0;
  it.before(0.0, 0.1);  // as much as is wanted
  const double steady = 0.1 + 2.0 * kTermPerN - it.damped * 0.1;
  ASSERT_NEAR(it.nullSpeed(), std::max(0.1, steady), 1e-12);
  it.input.F_p_N = 200.0;
  const double pressed = 0.1 + 200.0 * kTermPerN - it.damped * 0.1;
  EXPECT_NEAR(it.nullSpeed(), pressed, 1e-12);
  it.free.w_dd[0] = 3.0;
  EXPECT_NEAR(it.nullSpeed(), pressed + 0.5 * kTerm_s * 1.5, 1e-12);
  it.curvature = 0.7;
  EXPECT_NEAR(it.nullSpeed(), pressed + 0.5 * kTerm_s * (1.5 - 0.7), 1e-12);
  it.space.x_dot_eff_m_per_s = 0.2;  // it moves away: there is no feedforward of it
  EXPECT_NEAR(it.nullSpeed(), pressed, 1e-12);
}

TEST(AccelerationTerms, ComeToTheirFloorByTheVelocityGain) {
  AccelerationTerms it;
  it.input.x_dot_ff_m_per_s = -0.1;
  EXPECT_NEAR(it.nullSpeed(), it.share * 0.1, 1e-12);
  it.input.F_p_N = 2.0;
  EXPECT_NEAR(it.nullSpeed(), it.share * 0.1 + 2.0 * kTermPerN, 1e-12);
  it.input.F_p_N = -2.0;  // null_limit below F_th: P F_p lower
  it.input.x_dot_ff_m_per_s = 0.0;
  EXPECT_NEAR(it.nullSpeed(), -2.0 * kTermPerN, 1e-12);
  it.before(0.0, -0.03);  // P F_p is -0.02 m/s
  EXPECT_NEAR(it.nullSpeed(), -0.03 - 2.0 * kTermPerN + it.damped * 0.03 + it.share * 0.01, 1e-12);
}

/// As fast as the integral leaks, and no faster than k_v.
TEST(AccelerationTerms, FadeWithoutContact) {
  AccelerationTerms it;
  it.before(0.0, 0.3);
  EXPECT_NEAR(it.nullSpeed(), 0.3, 1e-12);
  it.input.integral_decay = 0.999;
  EXPECT_NEAR(it.nullSpeed(), 0.3 * 0.999, 1e-12);
  it.input.integral_decay = 0.0;
  EXPECT_NEAR(it.nullSpeed(), 0.3 * (1.0 - it.share), 1e-12);
}

/// The task's: from F_act on, and down to rest.
TEST(AccelerationTerms, OfTheTool) {
  AccelerationTerms it(Variant::kNullTask);
  it.input.F_p_N = 2.9;
  EXPECT_EQ(it.taskSpeed(), 0.0);
  it.input.F_p_N = 5.0;
  EXPECT_NEAR(it.taskSpeed(), 2.0 * kTermPerN, 1e-12);
  EXPECT_NEAR(it.state.It_m_per_s, 2.0 * kTermPerN, 1e-12);
  it.before(-0.2, 0.0);  // it gives way with 0.1 m/s
  const double damped = it.damped * 0.1;
  EXPECT_NEAR(it.taskSpeed(), 0.1 + 2.0 * kTermPerN - damped, 1e-12);
  it.input.F_p_N = 1.0;  // still open
  EXPECT_NEAR(it.taskSpeed(), 0.1 - std::min(it.share * 0.1, 2.0 * kTermPerN + damped), 1e-12);
  it.state.It_m_per_s = -0.01;
  EXPECT_NEAR(it.taskSpeed(), 0.1 - it.share * 0.1, 1e-12) << "closed";
  EXPECT_EQ(it.state.It_m_per_s, 0.0);
  for (const double excess_N : {0.0, 0.5}) {  // which opens it
    it.state.It_m_per_s = 0.0;
    it.input.F_p_N = 3.0 + excess_N;
    EXPECT_NEAR(it.taskSpeed(), 0.1 + excess_N * kTermPerN - damped, 1e-12);
  }
  AccelerationTerms one(Variant::kNullSpace);
  one.input.F_p_N = 5.0;
  EXPECT_EQ(one.taskSpeed(), 0.0) << "it has no such law";
}

/// What moves neither for the task nor for the contact comes to rest with k_v.
TEST(AccelerationTerms, LeaveTheRestToTheVelocityGain) {
  AccelerationTerms it;
  it.before(0.2, 0.0);
  it.free.w_dd[0] = 3.0;
  it.update();
  EXPECT_NEAR(it.retreat(), -0.5 * (1.0 - it.share) * (0.2 + 3.0 * kTerm_s), 1e-12);
  it.before(0.0, 0.3);  // the contact's, which u_n brings back
  it.free.w_dd.setZero();
  it.update();
  EXPECT_NEAR(it.retreat(), 0.0, 1e-12);
}

/// What joint limits ask for changes as they do, and is no part of the contact's.
TEST(AccelerationTerms, FollowWhatTheFreeNullSpaceDoes) {
  AccelerationTerms it;
  it.before(0.0, 0.1);
  it.free.cost_change = 0.02 * scaled(JointVector{{-1.0, 1.0}}, ScaledVector::Ones());
  it.cost = 0.12 * scaled(JointVector{{-1.0, 1.0}}, ScaledVector::Ones());
  EXPECT_NEAR(it.nullSpeed(), 0.0, 1e-12);
  EXPECT_NEAR(it.retreat(), 0.12, 1e-12);
}

}  // namespace
}  // namespace tactus
