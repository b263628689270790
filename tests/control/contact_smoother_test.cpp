#include "tactus/control/contact_smoother.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random.h"
#include "support/tactile_samples.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kCoverLength_m = 0.38;
constexpr double kSmootherSample_s = 0.004;
constexpr double kLeastForce_N = 0.2;
constexpr double kTouch_N = 1.2;
constexpr double kCoverRadius_m = 0.06;

TactileModuleConfig coverOf(double filter_cutoff_hz) {
  TactileModuleConfig module;
  module.length_m = kCoverLength_m;
  module.filter_cutoff_hz = filter_cutoff_hz;
  module.cover_radius_m = kCoverRadius_m;
  return module;
}

class Smoother : public testing::Test {
 protected:
  /// A sample of a touch whose force and moments are off by noise of sigma.
  void feel(double x_m, double force_N, double angle_rad, double sigma_N = 0.0) {
    TactileSample sample = test::touchAt(x_m, force_N, angle_rad, 1);
    sample.force_y_N += noise(sigma_N);
    sample.force_z_N += noise(sigma_N);
    sample.moment_y_Nm += 0.15 * noise(sigma_N);
    sample.moment_z_Nm += 0.15 * noise(sigma_N);
    locateContact(sample, test::moduleOfLength(kCoverLength_m), sensor_);
    sensor_.interval_s = kSmootherSample_s;
    smoother_.update({}, sensor_, X_BaseModule_, state_);
  }

  /// Twelve uniform numbers: near enough to a normal one.
  double noise(double sigma_N) {
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) sum += random_.uniform(-0.5, 0.5);
    return sigma_N * sum;
  }

  double angle() const {
    return std::atan2(state_.contact.direction.z(), state_.contact.direction.y());
  }

  test::Random random_{311};
  ContactSmoother smoother_{coverOf(15.0), 0.0};
  ContactSmootherState state_ = smoother_.initialState();
  ContactPointState sensor_;
  Pose X_BaseModule_;
};

TEST_F(Smoother, TakesTheFirstTouchAsItIs) {
  feel(0.3, 0.0, 0.0);
  EXPECT_EQ(state_.contact.direction, Vector3::Zero());
  feel(0.3, 1.5, 0.7);
  EXPECT_NEAR(angle(), 0.7, 1e-12);
  EXPECT_NEAR(state_.contact.position_m, 0.3, 1e-12);
  EXPECT_NEAR(state_.contact.force_N, 1.5, 1e-12);
}

TEST_F(Smoother, AContactThatStandsStillIsKeptWhileTheLinkMoves) {
  // The link turns about what touches it, and slides along itself; where that is, is told with an
  // error that shall be averaged out.
  for (int i = 0; i < 200; ++i) feel(0.3, 4.0, 0.0);
  for (int i = 1; i <= 100; ++i) {
    const double turn = 0.002 * i;
    X_BaseModule_.R_AB = Eigen::AngleAxisd(turn, Vector3::UnitZ()).toRotationMatrix();
    const double x_m = 0.3 - 0.0005 * i;
    const Vector3 p_Base(0.3, -0.06, 0.0);  // on the cover
    X_BaseModule_.p_AB =
        p_Base + 0.06 * X_BaseModule_.R_AB.col(1) - x_m * X_BaseModule_.R_AB.col(0);
    feel(x_m + (i % 2 == 0 ? 0.0005 : -0.0005), 4.0, 0.0);
    ASSERT_NEAR(state_.contact.position_m, x_m, 1e-4) << i;
    ASSERT_NEAR(angle(), 0.0, 1e-12) << "horizontal, and square to the link";
  }
}

TEST_F(Smoother, TheNormalOfAPostTurnsAboutALinkThatIsInclined) {
  // The link turns about the post without turning about itself; the normal, which stays horizontal,
  // then turns about the link.
  const double pitch = 0.6;
  const auto poseAt = [&](double yaw) {
    X_BaseModule_.R_AB =
        (Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
         Eigen::AngleAxisd(yaw * std::sin(pitch), Vector3::UnitX()))
            .toRotationMatrix();
    const Vector3 u = X_BaseModule_.R_AB.col(0);
    const Vector3 n = Vector3::UnitZ().cross(u).normalized();
    X_BaseModule_.p_AB = 0.06 * n - 0.2 * u;
    return std::atan2(n.dot(X_BaseModule_.R_AB.col(2)), n.dot(X_BaseModule_.R_AB.col(1)));
  };
  const double before = poseAt(0.0);
  for (int i = 0; i < 200; ++i) feel(0.2, 4.0, before);
  double now = before;
  for (int i = 1; i <= 150; ++i) {
    now = poseAt(0.001 * i);
    feel(0.2, 4.0, now);
    ASSERT_NEAR(angle(), now, 0.035) << i;
    ASSERT_NEAR(state_.contact.position_m, 0.2, 1e-3) << i;
  }
  EXPECT_GT(std::abs(now - before), 0.05);
}

TEST_F(Smoother, WeighsSamplesByTheSquareOfTheirForce) {
  feel(0.300, 3.0, 0.0);
  feel(0.301, 3.3, 0.0);  // not significant: 3.3 N (0.001 / 0.19)
  const double old = 9.0 * std::exp(-kSmootherSample_s / 1.0);
  EXPECT_NEAR(state_.contact.position_m, 0.3 + 0.001 * 10.89 / (10.89 + old), 1e-9);
}

TEST_F(Smoother, InAnImpactTheNewestSampleIsAllThatCounts) {
  for (int i = 0; i < 100; ++i) feel(0.300, 3.0, 0.0);
  feel(0.301, 3.7, 0.0);
  EXPECT_NEAR(state_.contact.position_m, 0.301, 1e-12);
}

TEST_F(Smoother, ForceBelowTheThresholdSaysNothing) {
  feel(0.300, 3.0, 0.5);
  feel(0.1, 1.2, -2.0);
  EXPECT_NEAR(state_.contact.position_m, 0.3, 1e-12);
  EXPECT_NEAR(angle(), 0.5, 1e-12);
  EXPECT_NEAR(state_.contact.force_N, 1.2, 1e-12) << "but is passed on";
}

TEST_F(Smoother, FollowsAnotherContactAtOnce) {
  for (int i = 0; i < 200; ++i) feel(0.1, 4.0, 0.0);
  feel(0.3, 4.5, 1.0);
  EXPECT_NEAR(state_.contact.position_m, 0.3, 0.002);
  EXPECT_NEAR(angle(), 1.0, 0.01);
}

TEST_F(Smoother, TheFiltersReboundIsNoContact) {
  for (int i = 0; i < 10; ++i) feel(0.3, 40.0, 0.5);
  feel(0.1, 7.0, 0.5 + M_PI);
  EXPECT_EQ(state_.contact.force_N, 0.0);
  EXPECT_NEAR(angle(), 0.5, 1e-12);
  EXPECT_NEAR(state_.contact.position_m, 0.3, 1e-12);
  feel(0.1, 16.0, 0.5 + M_PI);
  EXPECT_NEAR(state_.contact.force_N, 16.0, 1e-12) << "too much for a rebound";
  feel(0.3, 40.0, 0.5);
  for (int i = 0; i < 50; ++i) feel(0.3, 0.0, 0.5);
  feel(0.1, 2.0, 0.5 + M_PI);
  EXPECT_NEAR(state_.contact.force_N, 2.0, 1e-12) << "the blow is long over";
}

/// Whatever the filter makes of a blow, samples of it never show a contact on the other side.
TEST_F(Smoother, NoBlowTurnsTheContactAround) {
  for (int trial = 0; trial < 3000; ++trial) {
    const double cutoff_hz = random_.uniform(5.0, 40.0);
    const double blow_s = random_.uniform(0.001, 4.0 / cutoff_hz);
    const int stride = static_cast<int>(random_.uniform(1.0, 0.3e3 / cutoff_hz));  // cycles of 1 ms
    const int phase = static_cast<int>(random_.uniform(0.0, stride));
    const ContactSmoother smoother(coverOf(cutoff_hz), 0.0);
    ContactSmootherState state = smoother.initialState();
    ButterworthLowPass filter(cutoff_hz, 1e3);
    for (int i = 0; i < 1000; ++i) {
      const double force_N = filter.update(1e-3 * i < blow_s ? 1000.0 : 0.0);
      if (i % stride != phase) continue;
      locateContact(test::touchAt(0.2, force_N, 0.5, 1), test::moduleOfLength(kCoverLength_m),
                    sensor_);
      sensor_.interval_s = 1e-3 * stride;
      smoother.update({}, sensor_, X_BaseModule_, state);
      const bool is_turned =
          state.contact.direction.dot(Vector3(0.0, std::cos(0.5), std::sin(0.5))) < 0.0;
      ASSERT_FALSE(is_turned) << cutoff_hz << " Hz, " << blow_s << " s, every " << stride
                              << " ms, at " << i;
    }
  }
}

class SmootherWithFriction : public Smoother {
 protected:
  SmootherWithFriction() { smoother_ = ContactSmoother(coverOf(15.0), kFriction); }

  static constexpr double kFriction = 0.5;
};

/// However its force tilts within the cone while the link slides to and fro.
TEST_F(SmootherWithFriction, TheTiltOfOneContactIsAveraged) {
  const double tilt = 0.98 * std::atan(kFriction);
  for (int i = 0; i < 1000; ++i) {
    const double side = i % 24 < 12 ? 1.0 : -1.0;  // about 10 Hz
    feel(0.2 + 0.98 * side * kFriction * kCoverRadius_m, 5.0, 0.5 + side * tilt);
    if (i < 500) continue;
    ASSERT_NEAR(angle(), 0.5, 0.1 * tilt) << i;
    ASSERT_NEAR(state_.contact.position_m, 0.2, 0.1 * kFriction * kCoverRadius_m) << i;
  }
}

/// An arm that swings on its gears bounces, and meets the obstacle anew with another tilt each
/// time.
TEST_F(SmootherWithFriction, ABounceDoesNotTurnTheContact) {
  const double tilt = std::atan(kFriction);
  for (int i = 0; i < 500; ++i) feel(0.2, 5.0, 0.5);
  for (int bounce = 0; bounce < 10; ++bounce) {
    for (int i = 0; i < 20; ++i) feel(0.2, 0.0, 0.5);
    for (double force_N = 0.5; force_N < 6.0; force_N *= 1.5)
      feel(0.2, force_N, 0.5 + (bounce % 2 == 0 ? tilt : -tilt));
    ASSERT_NEAR(angle(), 0.5, 0.2 * tilt) << bounce;
  }
}

TEST_F(SmootherWithFriction, FollowsAnotherContactAtOnce) {
  for (int i = 0; i < 200; ++i) feel(0.1, 4.0, 0.0);
  feel(0.1, 4.5, 2.1 * std::atan(kFriction));
  EXPECT_NEAR(angle(), 2.1 * std::atan(kFriction), 0.02) << "turned by more than friction can";
  feel(0.1 + 2.1 * kFriction * kCoverRadius_m, 5.5, 2.1 * std::atan(kFriction));
  EXPECT_NEAR(state_.contact.position_m, 0.1 + 2.1 * kFriction * kCoverRadius_m, 0.002);
}

/// What the filter still shows of a blow turns the first force after it.
TEST_F(SmootherWithFriction, WhatIsSmallAfterABlowSaysNothingOfTheDirection) {
  for (int i = 0; i < 10; ++i) feel(0.3, 40.0, 0.5);
  feel(0.1, 7.0, 0.5 + 0.45 * M_PI);
  EXPECT_NEAR(angle(), 0.5, 1e-12);
  EXPECT_NEAR(state_.contact.position_m, 0.3, 1e-12);
  EXPECT_NEAR(state_.contact.force_N, 7.0, 1e-12) << "but is a force";
  for (int i = 0; i < 50; ++i) feel(0.3, 0.0, 0.5);
  feel(0.1, 7.0, 0.5 + 0.45 * M_PI);
  EXPECT_NEAR(angle(), 0.5 + 0.45 * M_PI, 0.01) << "the blow is long over";
}

TEST_F(Smoother, QuietensPointAndDirection) {
  for (const double sigma : {0.03, 0.1}) {
    for (int i = 0; i < 1000; ++i) feel(0.25, 5.0, 0.5, sigma);
    double raw = 0.0;
    double smooth = 0.0;
    for (int i = 0; i < 2000; ++i) {
      feel(0.25, 5.0, 0.5, sigma);
      raw += std::pow(std::atan2(sensor_.direction.z(), sensor_.direction.y()) - 0.5, 2.0);
      smooth += std::pow(angle() - 0.5, 2.0);
    }
    EXPECT_LT(smooth, 0.03 * raw) << sigma;
  }
}

TEST_F(Smoother, LearnsTheNoise) {
  for (const double sigma : {0.1, 0.2, 0.05}) {
    for (int i = 0; i < 2000; ++i) feel(0.25, 5.0, 0.5, sigma);
    EXPECT_NEAR(state_.significant_N, 6.0 * sigma, 1.5 * sigma) << sigma;
  }
  for (int i = 0; i < 2000; ++i) feel(0.25, 5.0, 0.5, 0.0);
  EXPECT_EQ(state_.significant_N, kLeastForce_N);
}

TEST_F(Smoother, DoesNotTakeAnImpactForNoise) {
  for (int i = 0; i < 100; ++i) feel(0.25, 0.0, 0.0, 0.02);
  double force = 0.0;
  for (int i = 0; i < 20; ++i) feel(0.25, force += 0.5 * i, 0.5, 0.02);  // to 95 N in 80 ms
  EXPECT_LT(state_.significant_N, 1.3 * kLeastForce_N);
}

TEST_F(Smoother, ForgetsDownToZeroAndNotToSubnormalNumbers) {
  feel(0.3, 5.0, 0.5);
  for (int i = 0; i < 80000; ++i) {  // five minutes
    feel(0.3, 0.0, 0.5);
    ASSERT_NE(std::fpclassify(state_.weight), FP_SUBNORMAL) << i;
    ASSERT_NE(std::fpclassify(state_.peak_N), FP_SUBNORMAL) << i;
  }
  EXPECT_EQ(state_.weight, 0.0);
  EXPECT_EQ(state_.peak_N, 0.0);
}

TEST_F(Smoother, StaysAUnitVectorOnTheCoverWhateverComes) {
  for (int i = 0; i < 20000; ++i) {
    feel(random_.uniform(-1.0, 1.0), random_.chance(0.2) ? 0.0 : random_.logUniform(1e-6, 1e6),
         random_.uniform(-4.0, 4.0), random_.logUniform(1e-6, 1e3));
    ASSERT_GE(state_.contact.position_m, -1e-12);
    ASSERT_LE(state_.contact.position_m, kCoverLength_m + 1e-12);
    const double length = state_.contact.direction.norm();
    if (length != 0.0) {
      ASSERT_NEAR(length, 1.0, 1e-12);
    }
    ASSERT_GE(state_.significant_N, kLeastForce_N);
    ASSERT_LE(state_.significant_N, 10.0 * kLeastForce_N);
  }
}

/// Squares of such forces are zero, and a ratio of them is none.
TEST_F(Smoother, StaysANumberWhereSquaresOfTheForceVanish) {
  Gains none;
  none.force.contact_threshold_N = 0.0;
  for (const double force_N : {1e-300, 1e-200, 1e-170, 1e-160}) {
    sensor_.force_N = force_N;
    sensor_.direction = Vector3::UnitZ();
    sensor_.position_m = 0.1;
    sensor_.interval_s = kSmootherSample_s;
    for (int i = 0; i < 3; ++i) smoother_.update(none.force, sensor_, X_BaseModule_, state_);
    ASSERT_TRUE(std::isfinite(state_.contact.position_m)) << force_N;
    // Learnt, or as it was before the first touch.
    const double length = state_.contact.direction.norm();
    ASSERT_LT(std::min(std::abs(length - 1.0), length), 1e-12) << force_N;
  }
}

}  // namespace
}  // namespace tactus
