#include <gtest/gtest.h>

#include "support/period.h"
#include "support/random_robot.h"
#include "tactus/control/control_law.h"
#include "tactus/control/null_speed_limit.h"

namespace tactus {
namespace {

using test::kPeriod_s;

struct ContactCase {
  explicit ContactCase(test::Random& random)
      : n(random.integer(2, kMaxJoints)),
        chain(test::randomChain(random, n)),
        inv_sqrt(scaled(test::randomWeights(random, n).cwiseSqrt().cwiseInverse(),
                        ScaledVector::Ones())) {
    gains.max_null_speed_m_per_s = random.logUniform(0.1, 5.0);
    gains.max_null_speed_rad_per_s = random.logUniform(0.1, 5.0);
    config.variant = random.chance(0.5)   ? Variant::kNullSpace
                     : random.chance(0.5) ? Variant::kNullTask
                                          : Variant::kNullJoint;
    space.a_scaled = scaled(random.vector(n, -1.0, 1.0), inv_sqrt);
    space.k_j = space.a_scaled.squaredNorm();
    space.k_n = space.k_j * random.logUniform(1e-4, 1.0);
    space.k_t = space.k_j - space.k_n;
    input.F_p_N = random.logUniform(0.01, 100.0);
    input.stiffness_N_per_m = random.logUniform(50.0, 1e4);
  }

  /// Largest component of u_n,q = b u_n against its limit.
  double excess(double u_n) const {
    double largest = 0.0;
    for (int i = 0; i < n; ++i) {
      const double b = inv_sqrt[i] * space.a_scaled[i];
      const double limit = chain.type(i) == JointType::kPrismatic ? gains.max_null_speed_m_per_s
                                                                  : gains.max_null_speed_rad_per_s;
      largest = std::max(largest, std::abs(b * u_n) / limit);
    }
    return largest;
  }

  int n;
  SerialChain chain;
  ScaledVector inv_sqrt;
  ForceControlConfig config;
  ForceGains gains;
  ContactSpace space;
  ControlLawInput input;
};

TEST(NullSpaceLimit, ScalesTheWholeVectorAndOnlyWhenNeeded) {
  test::Random random(111);
  int limited = 0;
  for (int i = 0; i < 5000; ++i) {
    const ContactCase c(random);
    const ControlLaw law(c.config, c.chain, c.inv_sqrt);
    ControlLawState state;
    ControlLawOutput u;
    law.update(c.gains, c.input, c.space, kPeriod_s, state, u);
    const double wanted = -2.0 * c.gains.damping * c.input.F_p_N /
                          (c.gains.time_constant_s * c.input.stiffness_N_per_m) *
                          invertRegularised(c.space.k_n, c.space.k_j);
    if (c.excess(wanted) <= 1.0) {
      ASSERT_NEAR(u.u_n, wanted, 1e-12 * std::abs(wanted));
    } else {
      ASSERT_NEAR(c.excess(u.u_n), 1.0, 1e-12) << "the fastest joint shall be at its limit";
      ASSERT_LT(u.u_n, 0.0) << "direction lost";
      ++limited;
    }
  }
  EXPECT_GT(limited, 500);
  EXPECT_LT(limited, 4500);
}

TEST(NullSpaceLimit, HoldsTheIntegralWhileLimited) {
  test::Random random(112);
  int held = 0;
  for (int i = 0; i < 2000; ++i) {
    const ContactCase c(random);
    const ControlLaw law(c.config, c.chain, c.inv_sqrt);
    ControlLawState state;
    ControlLawOutput u;
    law.update(c.gains, c.input, c.space, kPeriod_s, state, u);
    if (c.excess(u.u_n) > 1.0 - 1e-9) {
      ASSERT_EQ(state.V_m_per_s, 0.0);
      ++held;
    } else {
      ASSERT_GT(state.V_m_per_s, 0.0);
    }
  }
  EXPECT_GT(held, 200);
}

TEST(NullSpaceLimit, LeavesOtherSpacesAlone) {
  test::Random random(113);
  ContactCase c(random);
  c.gains.max_null_speed_m_per_s = c.gains.max_null_speed_rad_per_s = 1e-6;
  for (const Variant variant : {Variant::kJointSpace, Variant::kTaskSpace}) {
    c.config.variant = variant;
    const ControlLaw law(c.config, c.chain, c.inv_sqrt);
    ControlLawState state;
    ControlLawOutput u;
    law.update(c.gains, c.input, c.space, kPeriod_s, state, u);
    EXPECT_GT(std::abs(u.u_j + u.u_t), 1e-3);
    EXPECT_GT(state.V_m_per_s, 0.0);
  }
}

/// Gains may change while an arm runs: what is remembered of them is of these alone.
TEST(NullSpaceLimit, FollowsEachOfItsGains) {
  test::Random random(114);
  for (int i = 0; i < 500; ++i) {
    ContactCase c(random);
    const NullSpeedLimit limit(c.chain, c.inv_sqrt);
    const ScaledVector v =
        scaled(JointVector(random.vector(c.n, -20.0, 20.0)), ScaledVector::Ones());
    NullSpeedLimits remembered;
    for (int change = 0; change < 6; ++change) {
      (change % 2 ? c.gains.max_null_speed_m_per_s : c.gains.max_null_speed_rad_per_s) =
          random.logUniform(0.1, 5.0);
      NullSpeedLimits none;
      const double share = limit.share(c.gains, v, remembered);
      ASSERT_EQ(share, limit.share(c.gains, v, none));
      for (int joint = 0; joint < c.n; ++joint) {
        const double most = c.chain.type(joint) == JointType::kPrismatic
                                ? c.gains.max_null_speed_m_per_s
                                : c.gains.max_null_speed_rad_per_s;
        ASSERT_LE(share * std::abs(c.inv_sqrt[joint] * v[joint]), most * (1.0 + 1e-12));
      }
    }
  }
}

/// A push on top of another velocity: as much of it as the sum bears, which may be as fast as what
/// was there before.
TEST(NullSpaceLimit, OfAPushOnTopIsOfTheSum) {
  test::Random random(115);
  int whole = 0, cut = 0;
  for (int i = 0; i < 3000; ++i) {
    ContactCase c(random);
    const NullSpeedLimit limit(c.chain, c.inv_sqrt);
    c.gains.max_null_speed_m_per_s = random.logUniform(0.1, 5.0);
    c.gains.max_null_speed_rad_per_s = random.logUniform(0.1, 5.0);
    const auto draw = [&](double most) {
      return scaled(JointVector(random.vector(c.n, -most, most)), ScaledVector::Ones());
    };
    const ScaledVector v = draw(random.logUniform(0.01, 10.0));
    const ScaledVector push = random.chance(0.3) ? ScaledVector(-random.uniform(0.0, 2.0) * v)
                                                 : draw(random.logUniform(0.01, 1e4));
    NullSpeedLimits limits;
    const double share = limit.shareOnTop(c.gains, v, push, limits);
    ASSERT_GE(share, 0.0);
    ASSERT_LE(share, 1.0);
    double fullest = 0.0;
    for (int joint = 0; joint < c.n; ++joint) {
      const double before = std::abs(c.inv_sqrt[joint] * v[joint]);
      const double most = std::max(before, c.chain.type(joint) == JointType::kPrismatic
                                               ? c.gains.max_null_speed_m_per_s
                                               : c.gains.max_null_speed_rad_per_s);
      const double after = std::abs(c.inv_sqrt[joint] * (v[joint] + share * push[joint]));
      ASSERT_LE(after, most * (1.0 + 1e-9)) << i;
      if (push[joint] * (v[joint] + share * push[joint]) > 0.0)
        fullest = std::max(fullest, after / most);
    }
    if (share < 1.0) {
      ASSERT_NEAR(fullest, 1.0, 1e-9) << i;  // no more would do
    }
    (share < 1.0 ? cut : whole) += 1;
  }
  EXPECT_GT(whole, 300);
  EXPECT_GT(cut, 300);
}

}  // namespace
}  // namespace tactus
