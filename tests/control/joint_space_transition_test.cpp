#include "tactus/control/joint_space_transition.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/period.h"

/// The equations of the header by hand: T = 0.1 s, F_th = 1.2 N, F_rel = 0.3 N, F_eng = 0.5 N,
/// v_search = 0.01 m/s, d_t = 0.05 m, T_t,max = 1 s.
namespace tactus {
namespace {

using test::kPeriod_s;
const Vector3 kPoint(0.3, -0.2, 1.1);

ForceGains gains() {
  ForceGains gains;
  gains.transition.engage_force_N = 0.5;
  gains.transition.release_force_N = 0.3;
  gains.transition.search_speed_m_per_s = 0.01;
  return gains;
}

class JointSpace : public testing::Test {
 protected:
  explicit JointSpace(const ForceGains& with = gains()) : gains_(with) {}

  /// One cycle at a sensed force, `away_m` from kPoint, x_0 as given.
  IntegralShare update(double F_sen_N, double away_m = 0.0, double x_0 = 0.0) {
    followContact(gains_, {F_sen_N, 0.2, Vector3::UnitY()}, true, kPeriod_s, state_);
    const double F_p_N = std::max(0.0, F_sen_N - gains_.contact_threshold_N);
    return passTransition(gains_, {F_p_N, kPoint + Vector3(away_m, 0.0, 0.0), x_0}, kPeriod_s,
                          state_);
  }

  IntegralShare updateFor(double duration_s, double F_sen_N, double away_m = 0.0,
                          double x_0 = 0.0) {
    IntegralShare last;
    for (int i = 0; i < std::lround(duration_s / kPeriod_s); ++i)
      last = update(F_sen_N, away_m, x_0);
    return last;
  }

  ForceGains gains_;
  JointSpaceTransitionState state_;
};

TEST_F(JointSpace, DoesNothingBeforeTheFirstContact) {
  updateFor(0.5, 1.19);
  EXPECT_EQ(state_.gamma, 0.0);
  EXPECT_EQ(state_.kappa, 0.0);
  EXPECT_FALSE(state_.touching);
}

TEST_F(JointSpace, EngagesFasterWithMoreForce) {
  updateFor(0.1, 1.2 + 0.5);  // F_p = F_eng: time constant T
  EXPECT_NEAR(state_.gamma, 1.0 - std::exp(-1.0), 1e-9);
  state_ = {};
  updateFor(0.1, 1.2 + 0.25);  // half: a quarter of the rate
  EXPECT_NEAR(state_.gamma, 1.0 - std::exp(-0.25), 1e-9);
  state_ = {};
  gains_.transition.engage_force_N = 1.0;
  updateFor(0.1, 1.2 + 1.0);
  EXPECT_NEAR(state_.gamma, 1.0 - std::exp(-1.0), 1e-9);
}

TEST_F(JointSpace, KeepsItsFeedforwardBetweenReleaseAndThreshold) {
  updateFor(0.1, 1.7);
  const double gamma = state_.gamma;
  const IntegralShare integral = updateFor(2.0, 0.75);
  EXPECT_EQ(state_.gamma, gamma);
  EXPECT_TRUE(state_.touching);
  EXPECT_NEAR(integral.decay, std::exp(-0.001), 1e-12) << "V leaks with T_t,max";
  EXPECT_NEAR(integral.share, 0.5, 1e-12) << "halfway between 0.3 and 1.2 N";
}

TEST_F(JointSpace, UsesTheWholeIntegralInContact) {
  const IntegralShare integral = updateFor(0.1, 1.7);
  EXPECT_EQ(integral.decay, 1.0);
  EXPECT_EQ(integral.share, 1.0);
}

TEST_F(JointSpace, DropsTheIntegralWhenNothingIsFelt) {
  updateFor(0.5, 3.0);
  const IntegralShare integral = update(0.29);
  EXPECT_EQ(integral.decay, 0.0);
  EXPECT_EQ(integral.share, 0.0);
  EXPECT_FALSE(state_.touching);
}

TEST_F(JointSpace, ReturnsToWhereContactWasLost) {
  updateFor(2.0, 3.0);
  const double engaged = state_.gamma;
  ASSERT_NEAR(engaged, 1.0, 1e-9);
  // At |x_0| = 0.05 m/s and delta = d_t / 4: g = 1 - 1/4 - 0.2.
  updateFor(0.1, 0.0, 0.0125, -0.05);
  EXPECT_NEAR(state_.gamma, 0.55 + (engaged - 0.55) * std::exp(-1.0), 1e-9);
  updateFor(2.0, 0.0, 0.0125, -0.05);
  EXPECT_NEAR(state_.gamma, 0.55, 1e-8);
  updateFor(2.0, 0.0, 0.0, -0.05);
  EXPECT_NEAR(state_.gamma, 0.55, 1e-8) << "only falls";
}

TEST_F(JointSpace, LetsGoWhereTheArmWouldNotMoveOrIsFarAway) {
  for (const double x_0 : {0.0, -0.009, -10.0}) {
    state_ = {};
    updateFor(2.0, 3.0);
    updateFor(3.0, 0.0, 0.0501, x_0);
    EXPECT_EQ(state_.gamma, 0.0) << x_0;
    EXPECT_LT(state_.kappa, 0.051) << "three times T_t,max later";
  }
}

TEST_F(JointSpace, WithoutASearchLetsGoByDistanceAlone) {
  gains_.transition.search_speed_m_per_s = 0.0;
  for (const double x_0 : {0.0, -0.05}) {
    state_ = {};
    updateFor(2.0, 3.0);
    updateFor(2.0, 0.0, 0.0125, x_0);
    EXPECT_NEAR(state_.gamma, 0.75, 1e-8);
  }
}

TEST_F(JointSpace, PullComesWithTheFeedforwardAndGoesGently) {
  updateFor(0.1, 3.0);
  EXPECT_NEAR(state_.kappa, 1.0 - std::exp(-1.0), 0.1)
      << "with T, behind a gamma that rises faster";
  updateFor(2.0, 3.0);
  EXPECT_NEAR(state_.kappa, 1.0, 1e-6);
  const double kappa = state_.kappa;
  updateFor(0.1, 0.0, 0.0, -0.05);
  EXPECT_NEAR(state_.kappa, kappa * std::exp(-0.1), 1e-9) << "with T_t,max";
}

/// After a rest it comes with T_t,max, until it has regained 0.95 of what it shall be.
TEST_F(JointSpace, PullComesGentlyAfterARest) {
  updateFor(2.0, 3.0);
  restTransition(state_);
  EXPECT_EQ(state_.kappa, 0.0);
  updateFor(1.0, 3.0);
  EXPECT_NEAR(state_.kappa, 1.0 - std::exp(-1.0), 1e-6);
  updateFor(1.9, 3.0);
  EXPECT_NEAR(state_.kappa, 1.0 - std::exp(-2.9), 1e-6) << "0.945";
  updateFor(0.2, 3.0);
  EXPECT_NEAR(state_.kappa, 1.0 - 0.05 * std::exp(-1.04), 1e-3) << "with T from 0.95 on, at 3 s";
}

/// Once nothing is felt there is nothing to regain.
TEST_F(JointSpace, PullComesAtOnceWhereARestLeftNothing) {
  updateFor(2.0, 3.0);
  restTransition(state_);
  update(0.0);
  EXPECT_FALSE(state_.has_rested);
  updateFor(0.1, 3.0);
  EXPECT_GT(state_.kappa, 0.5);
}

TEST_F(JointSpace, AFeedforwardThatIsNextToNothingIsNone) {
  for (const double gamma : {0.9e-6, 1.1e-6}) {
    state_ = {};
    state_.gamma = gamma;
    state_.p_BaseLost = kPoint;
    update(0.0, 0.0, -0.05);
    EXPECT_EQ(state_.gamma, gamma < 1e-6 ? 0.0 : gamma);
  }
}

/// Its contact is lost below F_rel alone, and felt above it alone.
TEST_F(JointSpace, IsTouchingAtTheReleaseForce) {
  updateFor(0.1, 3.0);
  update(0.3);
  EXPECT_TRUE(state_.touching);
  followContact(gains_, {0.3, 0.35, Vector3::UnitZ()}, false, kPeriod_s, state_);
  EXPECT_EQ(state_.contact.position_m, 0.2) << "that says nothing of the place";
  followContact(gains_, {0.31, 0.35, Vector3::UnitZ()}, false, kPeriod_s, state_);
  EXPECT_EQ(state_.contact.position_m, 0.35) << "at once, as the arm rests";
}

TEST_F(JointSpace, PullFadesToZeroAndNotToSubnormalNumbers) {
  state_.kappa = 1e-90;  // 1e-100 after 23 s
  updateFor(20.0, 0.0);
  EXPECT_GT(state_.kappa, 0.0);
  updateFor(5.0, 0.0);
  EXPECT_EQ(state_.kappa, 0.0);
}

TEST_F(JointSpace, TakesThePointAtOnceFirstAndSmoothlyLater) {
  followContact(gains_, {2.0, 0.1, Vector3::UnitY()}, true, kPeriod_s, state_);
  EXPECT_EQ(state_.contact.position_m, 0.1);
  EXPECT_EQ(state_.contact.direction, Vector3(Vector3::UnitY()));
  state_.gamma = 0.5;
  followContact(gains_, {2.0, 0.2, Vector3::UnitZ()}, true, kPeriod_s, state_);
  const double share = 1.0 - std::exp(-kPeriod_s / gains_.time_constant_s);
  const Vector3 expected = Vector3(0.0, 1.0 - share, share).normalized();
  EXPECT_LT((state_.contact.direction - expected).norm(), 1e-12);
  for (int i = 1; i < 100; ++i)
    followContact(gains_, {2.0, 0.2, Vector3::UnitZ()}, true, kPeriod_s, state_);
  EXPECT_NEAR(state_.contact.position_m, 0.2 - 0.1 * std::exp(-1.0), 1e-9);
  EXPECT_NEAR(state_.contact.direction.norm(), 1.0, 1e-12);
  EXPECT_GT(state_.contact.direction.y(), 0.1);
  EXPECT_GT(state_.contact.direction.z(), 0.5);
}

TEST_F(JointSpace, FreezesThePointWhenNothingIsFelt) {
  followContact(gains_, {2.0, 0.1, Vector3::UnitY()}, true, kPeriod_s, state_);
  followContact(gains_, {0.3, 0.3, Vector3::UnitZ()}, true, kPeriod_s, state_);
  EXPECT_EQ(state_.contact.force_N, 0.3);
  EXPECT_EQ(state_.contact.position_m, 0.1);
  EXPECT_EQ(state_.contact.direction, Vector3(Vector3::UnitY()));
}

TEST_F(JointSpace, StaysANumberWithoutADirection) {
  followContact(gains_, {2.0, 0.1, Vector3::Zero()}, true, kPeriod_s, state_);
  EXPECT_EQ(state_.contact.direction, Vector3(Vector3::Zero()));
}

class JointSpaceAtOnce : public JointSpace {
 protected:
  JointSpaceAtOnce()
      : JointSpace([] {
          ForceGains at_once = gains();
          at_once.transition.engage_force_N = 0.0;
          return at_once;
        }()) {}
};

TEST_F(JointSpaceAtOnce, EngagesAtOnceWithoutARange) {
  update(1.2001);
  EXPECT_EQ(state_.gamma, 1.0);
}

}  // namespace
}  // namespace tactus
