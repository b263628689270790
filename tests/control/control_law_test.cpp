#include "tactus/control/control_law.h"

#include <gtest/gtest.h>

#include "support/period.h"
#include "support/rail_robot.h"

/// Law (5) by hand: T = 0.1 s, d = 0.5, c = 1000 N/m, so P = 2 d / (T c) = 0.01 m/(s N).
namespace tactus {
namespace {

using test::kPeriod_s;

ForceControlConfig lawOf(Variant variant, int order = 2) {
  ForceControlConfig config;
  config.variant = variant;
  config.order = order;
  return config;
}

ContactSpace handmadeSpace() {
  ContactSpace space;
  space.a_scaled = ScaledVector::Zero();
  space.a_scaled.head<2>() << 0.3, -0.4;
  space.k_j = 0.25;
  space.k_n = 0.2;
  space.k_t = 0.05;
  return space;
}

struct Result {
  ControlLawState state;
  ControlLawOutput u;
};

Result updateOnce(const ForceControlConfig& config, const ControlLawInput& input,
                  ControlLawState state = {}, const ContactSpace& space = handmadeSpace()) {
  const ControlLaw law(config, test::railChain(), ScaledVector::Ones());
  Result result{state, {}};
  law.update({}, input, space, kPeriod_s, result.state, result.u);
  return result;
}

const ControlLawInput kTouch{.F_p_N = 4.0, .stiffness_N_per_m = 1000.0, .x_dot_ff_m_per_s = -0.02};
const ControlLawState kBefore{.V_m_per_s = 0.003, .It_m_per_s = 0.001, .null_speed = {}};
constexpr double kSingle = -0.02 - 0.01 * 4.0 - 0.003;     // x_ff - P F_p - V
constexpr double kSecond = -(0.01 * (4.0 - 3.8) + 0.001);  // -(P (F_p - F_act) + I)

TEST(ControlLaw, NoneCommandsNothing) {
  const Result r = updateOnce(lawOf(Variant::kNone), kTouch, kBefore);
  EXPECT_EQ(r.u.u_n, 0.0);
  EXPECT_EQ(r.u.u_j, 0.0);
  EXPECT_EQ(r.u.u_t, 0.0);
}

TEST(ControlLaw, EverySingleSpaceAnswersInItsOwnSpace) {
  const Result n = updateOnce(lawOf(Variant::kNullSpace), kTouch, kBefore);
  EXPECT_NEAR(n.u.u_n, kSingle / 0.2, 1e-15);
  EXPECT_EQ(n.u.u_j, 0.0);
  EXPECT_EQ(n.u.u_t, 0.0);
  const Result j = updateOnce(lawOf(Variant::kJointSpace), kTouch, kBefore);
  EXPECT_NEAR(j.u.u_j, kSingle / 0.25, 1e-15);
  EXPECT_EQ(j.u.u_n, 0.0);
  EXPECT_EQ(j.u.u_t, 0.0);
  const Result t = updateOnce(lawOf(Variant::kTaskSpace), kTouch, kBefore);
  EXPECT_NEAR(t.u.u_t, kSingle / 0.05, 1e-15);
  EXPECT_EQ(t.u.u_n, 0.0);
  EXPECT_EQ(t.u.u_j, 0.0);
}

TEST(ControlLaw, MultiSpaceAddsTheSecondSpace) {
  const Result task = updateOnce(lawOf(Variant::kNullTask), kTouch, kBefore);
  EXPECT_NEAR(task.u.u_n, kSingle / 0.2, 1e-15);
  EXPECT_NEAR(task.u.u_t, kSecond / 0.05, 1e-15);
  EXPECT_EQ(task.u.u_j, 0.0);
  const Result joint = updateOnce(lawOf(Variant::kNullJoint), kTouch, kBefore);
  EXPECT_NEAR(joint.u.u_n, kSingle / 0.2, 1e-15);
  EXPECT_NEAR(joint.u.u_j, kSecond / 0.25, 1e-15);
  EXPECT_EQ(joint.u.u_t, 0.0);
}

TEST(ControlLaw, IntegratesAfterUseWithTheStiffnessInside) {
  const Result r = updateOnce(lawOf(Variant::kNullTask), kTouch, kBefore);
  EXPECT_NEAR(r.state.V_m_per_s, 0.003 + 0.001 * 4.0 / (0.01 * 1000.0), 1e-16);
  EXPECT_NEAR(r.state.It_m_per_s, 0.001 + 0.001 * 0.2 / (0.01 * 1000.0), 1e-16);
}

TEST(ControlLaw, IntegratesForASecondSpaceOnlyWhereThereIsOne) {
  for (const Variant variant :
       {Variant::kNullSpace, Variant::kJointSpace, Variant::kTaskSpace, Variant::kNullLimit})
    EXPECT_EQ(updateOnce(lawOf(variant), kTouch).state.It_m_per_s, 0.0);
  for (const Variant variant : {Variant::kNullTask, Variant::kNullJoint})
    EXPECT_GT(updateOnce(lawOf(variant), kTouch).state.It_m_per_s, 0.0);
}

TEST(ControlLaw, AChangeOfStiffnessDoesNotMoveTheIntegralPart) {
  ControlLawInput input = kTouch;
  input.F_p_N = 0.0;
  const Result soft = updateOnce(lawOf(Variant::kJointSpace), input, kBefore);
  input.stiffness_N_per_m = 50000.0;
  const Result stiff = updateOnce(lawOf(Variant::kJointSpace), input, kBefore);
  EXPECT_EQ(soft.u.u_j, stiff.u.u_j);
}

TEST(ControlLaw, TheSignedForceAsksForMoreContactWhereItIsFeltBelowTheThreshold) {
  const ForceGains gains;
  const double threshold_N = gains.contact_threshold_N;
  const double release_N = gains.transition.release_force_N;
  EXPECT_NEAR(signedContactForce_N(gains, 5.0), 3.8, 1e-15);
  EXPECT_NEAR(signedContactForce_N(gains, 1.0), -0.2, 1e-15);
  EXPECT_NEAR(signedContactForce_N(gains, 0.5), -0.2, 1e-15) << "and less where it is almost lost";
  for (const double none_N : {threshold_N, release_N, 0.1, 0.0})
    EXPECT_EQ(signedContactForce_N(gains, none_N), 0.0) << none_N;
  for (double force_N = 0.0; force_N < 3.0; force_N += 1e-3)
    EXPECT_NEAR(signedContactForce_N(gains, force_N), signedContactForce_N(gains, force_N + 1e-3),
                1e-3 + 1e-12);
}

TEST(ControlLaw, ANegativeForceTakesTheIntegralDownToNothing) {
  ControlLawInput input = kTouch;
  input.F_p_N = -0.2;
  EXPECT_NEAR(updateOnce(lawOf(Variant::kNullLimit), input, kBefore).state.V_m_per_s,
              0.003 - 0.001 * 0.2 / (0.01 * 1000.0), 1e-15);
  EXPECT_EQ(updateOnce(lawOf(Variant::kNullLimit), input, {}).state.V_m_per_s, 0.0);
}

TEST(ControlLaw, WhatTheLimitsCutIsTakenOffTheIntegralEvenWhileItIsHeld) {
  ControlLawInput input = kTouch;
  input.hold_integral = true;
  EXPECT_EQ(updateOnce(lawOf(Variant::kNullLimit), input, kBefore).state.V_m_per_s, 0.003);
  input.cut_m_per_s = 0.1;
  EXPECT_NEAR(updateOnce(lawOf(Variant::kNullLimit), input, kBefore).state.V_m_per_s,
              0.003 + 0.001 * 4.0 / (0.01 * 1000.0) - 0.001 * 0.1 / 0.1, 1e-16)
      << "V gets dt F_p / (T^2 c) - dt cut / T";
}

TEST(ControlLaw, FirstOrderHasNoIntegralAndTheGainOfItsOwn) {
  const Result r = updateOnce(lawOf(Variant::kJointSpace, 1), kTouch);
  EXPECT_NEAR(r.u.u_j, (-0.02 - 4.0 / (0.1 * 1000.0)) / 0.25, 1e-15);
  EXPECT_EQ(r.state.V_m_per_s, 0.0);
  EXPECT_EQ(r.state.It_m_per_s, 0.0);
  const Result multi = updateOnce(lawOf(Variant::kNullTask, 1), kTouch);
  EXPECT_NEAR(multi.u.u_t, -0.2 / (0.1 * 1000.0) / 0.05, 1e-15);
}

TEST(ControlLaw, TheIntegralDecaysBeforeItIsUsed) {
  ControlLawInput input = kTouch;
  input.F_p_N = 0.0;
  input.x_dot_ff_m_per_s = 0.0;
  input.integral_decay = 0.5;
  const Result r = updateOnce(lawOf(Variant::kJointSpace), input, kBefore);
  EXPECT_NEAR(r.u.u_j, -0.0015 / 0.25, 1e-16);
  EXPECT_NEAR(r.state.V_m_per_s, 0.0015, 1e-16);
}

TEST(ControlLaw, TheIntegralFadesToZeroAndNotToSubnormalNumbers) {
  ControlLawInput gone{.stiffness_N_per_m = 1000.0, .integral_decay = 0.999};
  const ControlLawState before{.V_m_per_s = 1e-99, .It_m_per_s = 0.0, .null_speed = {}};
  EXPECT_DOUBLE_EQ(updateOnce(lawOf(Variant::kNullTask), gone, before).state.V_m_per_s, 0.999e-99);
  gone.integral_decay = 1e-2;
  EXPECT_EQ(updateOnce(lawOf(Variant::kNullTask), gone, before).state.V_m_per_s, 0.0);
}

TEST(ControlLaw, BoundsItsAnswerWhereASpaceHardlyMovesThePoint) {
  ContactSpace space = handmadeSpace();
  space.k_n = 0.0;
  const Result r = updateOnce(lawOf(Variant::kNullSpace), kTouch, kBefore, space);
  EXPECT_NEAR(r.u.u_n, std::max(kSingle / (1e-3 * 0.25), -5.0 / 0.4), 1e-9);
  space = handmadeSpace();
  space.k_t = 0.0;
  const Result t = updateOnce(lawOf(Variant::kTaskSpace), kTouch, kBefore, space);
  EXPECT_NEAR(t.u.u_t, kSingle / (1e-3 * 0.25), 1e-9);
}

}  // namespace
}  // namespace tactus
