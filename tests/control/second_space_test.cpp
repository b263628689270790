#include <gtest/gtest.h>

#include <cmath>

#include "support/period.h"
#include "support/rail_robot.h"
#include "tactus/control/control_law.h"

/// The second space of the multi-space variants, (7): one-sided as a sum, with a windowed integral.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kAct_N = 3.8;
constexpr double kLawStiffness_N_per_m = 1000.0;

class SecondSpace : public testing::Test {
 protected:
  SecondSpace() : law_(config(), test::railChain(), ScaledVector::Ones()) {
    space_.a_scaled = ScaledVector::Zero();
    space_.k_j = space_.k_n = space_.k_t = 1.0;  // then u is a velocity
  }

  double update(double F_p_N) {
    ControlLawOutput u;
    law_.update({}, {F_p_N, kLawStiffness_N_per_m, 0.0, 1.0}, space_, kPeriod_s, state_, u);
    return u.u_t;
  }

  static ForceControlConfig config() {
    ForceControlConfig config;
    config.variant = Variant::kNullTask;
    return config;
  }

  ControlLaw law_;
  ContactSpace space_;
  ControlLawState state_;
};

TEST_F(SecondSpace, SleepsBelowTheActivationForce) {
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(update(kAct_N * i / 1000.0), 0.0);
    EXPECT_EQ(state_.It_m_per_s, 0.0) << "the window has not opened";
  }
}

TEST_F(SecondSpace, AnswersTheExcessAboveTheActivationForce) {
  EXPECT_NEAR(update(kAct_N + 2.0), -0.01 * 2.0, 1e-15);
  EXPECT_NEAR(state_.It_m_per_s, kPeriod_s * 2.0 / (0.01 * kLawStiffness_N_per_m), 1e-16);
  EXPECT_NEAR(update(kAct_N + 2.0), -0.01 * 2.0 - 0.0002, 1e-15);
}

TEST_F(SecondSpace, ProportionalPartWorksOnBothSidesWhileTheWindowIsOpen) {
  for (int i = 0; i < 1000; ++i) update(kAct_N + 5.0);
  const double I = state_.It_m_per_s;
  ASSERT_NEAR(I, 0.5, 1e-9);
  // Cutting the proportional part alone, as printed, would give -0.5 here.
  EXPECT_NEAR(update(kAct_N - 2.0), -(I - 0.01 * 2.0), 1e-12);
}

TEST_F(SecondSpace, NeverPullsTowardsTheObstacle) {
  for (int i = 0; i < 100; ++i) update(kAct_N + 1.0);
  ASSERT_GT(state_.It_m_per_s, 0.0);
  EXPECT_EQ(update(0.0), 0.0) << "the sum P (F_p - F_act) + I is negative";
}

TEST_F(SecondSpace, WindowClosesAtZeroAndStaysClosedBelow) {
  for (int i = 0; i < 50; ++i) update(kAct_N + 1.0);
  int open_cycles = 0;
  while (state_.It_m_per_s > 0.0 && open_cycles < 1000) {
    update(kAct_N - 1.0);
    ++open_cycles;
  }
  EXPECT_NEAR(open_cycles, 50, 1) << "what went in must come out";
  for (int i = 0; i < 500; ++i) update(0.0);
  EXPECT_EQ(state_.It_m_per_s, 0.0) << "no debt is stored";
  EXPECT_NEAR(update(kAct_N + 1.0), -0.01, 1e-15) << "the next contact starts afresh";
}

TEST_F(SecondSpace, OutputIsContinuousInTheForce) {
  double F_before_N = 0.0;
  double u_before = update(F_before_N);
  for (int i = 1; i < 20000; ++i) {
    const double F_N = kAct_N + 4.0 * std::sin(i * 1e-3);
    const double u = update(F_N);
    if (i > 1) {
      // Change of P (F_p - F_act) plus one step of the integral.
      ASSERT_LE(std::abs(u - u_before),
                0.01 * std::abs(F_N - F_before_N) + 1e-4 * std::abs(F_before_N - kAct_N) + 1e-12)
          << i;
    }
    ASSERT_LE(u, 0.0);
    ASSERT_GE(state_.It_m_per_s, 0.0);
    u_before = u;
    F_before_N = F_N;
  }
}

}  // namespace
}  // namespace tactus
