#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tactus/control/contact_smoother.h"

/// Single samples, and what is remembered of them, by the equations of contact_smoother.h.
namespace tactus {
namespace {

constexpr double kReading_s = 0.004;
constexpr double kS_min_N = 0.2;
constexpr double kFading = 0.99600798934;  // exp(-4 ms / 1 s)

TactileModuleConfig smoothedModule() {
  TactileModuleConfig module;
  module.length_m = 0.4;
  module.cover_radius_m = 0.06;
  module.filter_cutoff_hz = 15.0;
  return module;
}

struct SmootherRig {
  explicit SmootherRig(double friction = 0.0, bool is_one_of_several = false)
      : smoother(smoothedModule(), friction, is_one_of_several), state(smoother.initialState()) {}
  void read(double force_N, double position_m, const Vector3& direction = Vector3::UnitY()) {
    smoother.update({}, {force_N, position_m, direction, kReading_s}, X_BaseModule, state);
  }

  ContactSmoother smoother;
  ContactSmootherState state;
  Pose X_BaseModule{Matrix3::Identity(), Vector3::Zero()};
};

TEST(SmootherSteps, BeginInTheMiddleOfTheModule) {
  EXPECT_EQ(SmootherRig().state.contact.position_m, 0.2);
}

/// Two readings count together as they do by the squares of their forces; older ones fade.
TEST(SmootherSteps, AddWeights) {
  SmootherRig rig;
  rig.read(3.0, 0.3);
  EXPECT_NEAR(rig.state.weight, 9.0, 1e-12);
  rig.read(3.2, 0.3);
  EXPECT_NEAR(rig.state.weight, 9.0 * kFading + 3.2 * 3.2, 1e-9);
  rig.read(1.0, 0.3);
  EXPECT_NEAR(rig.state.weight, (9.0 * kFading + 3.2 * 3.2) * kFading, 1e-9)
      << "below the threshold nothing comes to it";
}

TEST(SmootherSteps, RememberOneOfSeveralFourTimesAsLong) {
  SmootherRig rig(0.0, true);
  rig.read(3.0, 0.3);
  rig.read(3.0, 0.3);
  EXPECT_NEAR(rig.state.weight, 9.0 * std::exp(-kReading_s / 4.0) + 9.0, 1e-9);
}

/// What touches does not turn with a link that turns about itself.
TEST(SmootherSteps, KeepTheDirectionInTheBaseFrame) {
  SmootherRig rig;
  rig.read(3.0, 0.3);
  rig.X_BaseModule.R_AB = Eigen::AngleAxisd(0.3, Vector3::UnitX()).toRotationMatrix();
  rig.read(0.5, 0.3, Vector3::UnitZ());  // too little to say anything
  EXPECT_LT((rig.X_BaseModule.R_AB * rig.state.contact.direction - Vector3::UnitY()).norm(), 1e-12);
  SmootherRig turning;
  turning.read(3.0, 0.3);
  turning.X_BaseModule.R_AB = Eigen::AngleAxisd(0.3, Vector3::UnitZ()).toRotationMatrix();
  turning.read(0.5, 0.3, Vector3::UnitZ());
  EXPECT_LT((turning.state.contact.direction - Vector3::UnitY()).norm(), 1e-12)
      << "as far as it is across the link";
}

/// A link whose axis turns by 0.05 forgets half.
TEST(SmootherSteps, ForgetWhereTheAxisTurns) {
  SmootherRig rig;
  rig.read(3.0, 0.0);
  const double turn_rad = 2.0 * std::asin(0.025);
  rig.X_BaseModule.R_AB = Eigen::AngleAxisd(turn_rad, Vector3::UnitZ()).toRotationMatrix();
  rig.read(3.0, 0.0);
  EXPECT_NEAR(rig.state.weight, 9.0 * kFading / 2.0 + 9.0, 1e-9);
}

/// An impact grows by a fifth from sample to sample; of one of several by twice the noise, too.
TEST(SmootherSteps, KnowAnImpact) {
  for (const bool is_one_of_several : {false, true}) {
    SmootherRig rig(0.0, is_one_of_several);
    rig.read(1.7, 0.3);
    rig.read(1.19 * 1.7, 0.3);
    EXPECT_GT(rig.state.weight, 1.1 * std::pow(1.19 * 1.7, 2.0)) << is_one_of_several;
    rig.read(1.21 * 1.19 * 1.7, 0.3);  // by 0.42 N
    EXPECT_NEAR(rig.state.weight, std::pow(1.21 * 1.19 * 1.7, 2.0), 1e-9) << is_one_of_several;
  }
  SmootherRig one_of_several(0.0, true);
  one_of_several.read(1.3, 0.3);
  one_of_several.read(1.3 + 0.39, 0.3);  // by 30 %
  EXPECT_GT(one_of_several.state.weight, 1.1 * 1.69 * 1.69) << "less than twice the noise";
  EXPECT_NEAR(one_of_several.state.significant_N, kS_min_N, 0.01);
}

/// What grows by as much as that and no more is none yet.
TEST(SmootherSteps, TakeTheLeastImpactForGrowth) {
  SmootherRig rig;
  rig.read(5.0, 0.3);
  const double before = rig.state.weight;
  rig.read(1.2 * 5.0, 0.3);
  EXPECT_NEAR(rig.state.weight, before * kFading + 36.0, 1e-9);
  SmootherRig one_of_several(0.0, true);
  for (int i = 0; i < 10; ++i) one_of_several.read(3.0, 0.3);
  for (int i = 0; i < 50; ++i) one_of_several.read(2.0 * kS_min_N, 0.3);
  ASSERT_EQ(one_of_several.state.significant_N, kS_min_N);
  one_of_several.read(4.0 * kS_min_N, 0.3);  // by twice the noise
  EXPECT_GT(one_of_several.state.weight, 50.0);
}

/// One of several rests at F_th, so it counts from the mean of F_rel and F_th on.
TEST(SmootherSteps, CountFromTheThresholdOn) {
  const auto isTaken = [](bool is_one_of_several, double force_N) {
    SmootherRig rig(0.0, is_one_of_several);
    rig.read(force_N, 0.3);
    return rig.state.contact.position_m == 0.3;
  };
  EXPECT_FALSE(isTaken(false, 1.2));
  EXPECT_TRUE(isTaken(false, 1.2001));
  EXPECT_FALSE(isTaken(true, 0.75));  // of 0.3 and 1.2
  EXPECT_TRUE(isTaken(true, 0.7501));
}

/// One of several sliders: within what friction can do it is averaged, also in an impact.
TEST(SmootherSteps, AverageWhatFrictionCanDo) {
  const double mu = 0.5;
  const double sine = mu / std::hypot(1.0, mu);
  const auto isImpact = [&](double turn, double shift_m) {
    SmootherRig rig(mu);
    rig.read(2.0, 0.2);
    const double angle = 2.0 * std::asin(0.5 * turn);
    rig.read(4.0, 0.2 + shift_m, Vector3(0.0, std::cos(angle), std::sin(angle)));
    return rig.state.weight < 16.0 + 1e-9;
  };
  EXPECT_FALSE(isImpact(1.99 * sine, 1.99 * mu * 0.06));
  EXPECT_TRUE(isImpact(2.01 * sine, 0.0));
  EXPECT_TRUE(isImpact(0.0, 2.01 * mu * 0.06));
}

/// The highest force is forgotten with 1.5 / f_c; from the other side below 0.35 of it is none.
TEST(SmootherSteps, KnowTheFiltersRebound) {
  const double fading = std::exp(-kReading_s * 15.0 / 1.5);
  for (const double share : {0.345, 0.355}) {
    SmootherRig rig;
    rig.read(40.0, 0.3);
    const double force_N = share * 40.0 * fading;
    rig.read(force_N, 0.3, -Vector3::UnitY());
    EXPECT_NEAR(rig.state.peak_N, 40.0 * fading, 1e-9);
    EXPECT_EQ(rig.state.contact.force_N, share < 0.35 ? 0.0 : force_N);
  }
  SmootherRig same_side;
  same_side.read(40.0, 0.3);
  same_side.read(2.0, 0.3);
  EXPECT_EQ(same_side.state.contact.force_N, 2.0);
  same_side.read(1.9, 0.3, Vector3::UnitZ());
  EXPECT_EQ(same_side.state.contact.force_N, 1.9) << "nor is square to it the other side";
}

/// With friction what is left of a blow says nothing, from whatever side.
TEST(SmootherSteps, LearnNothingOfABlowsEndWithFriction) {
  for (const double mu : {0.0, 0.5}) {
    SmootherRig rig(mu);
    rig.read(40.0, 0.1);
    rig.read(3.0, 0.35);
    EXPECT_EQ(rig.state.contact.position_m == 0.1, mu > 0.0);
  }
}

/// Rather than for a signal.
TEST(SmootherSteps, TakeAsMuchAsTheMedianForNoise) {
  SmootherRig rig;
  rig.read(0.48 * kS_min_N, 0.2);
  EXPECT_EQ(rig.state.significant_N, kS_min_N);
}

/// By 1 % a sample: up where the second difference is above 0.48 of it, else down; within 10 s_min.
TEST(SmootherSteps, TrackTheNoise) {
  SmootherRig rig;
  rig.read(0.0, 0.2);
  EXPECT_EQ(rig.state.significant_N, kS_min_N) << "at least";
  SmootherRig struck;
  struck.read(3.0, 0.2);
  EXPECT_NEAR(struck.state.significant_N, 1.01 * kS_min_N, 1e-12) << "from the first sample on";
  rig.state.significant_N = 1.0;
  rig.read(0.47, 0.2);  // second difference 0.47 N
  EXPECT_NEAR(rig.state.significant_N, 0.99, 1e-12);
  rig.state.significant_N = 1.0;
  rig.read(0.47 + 0.96, 0.2);  // 0.49 N
  EXPECT_NEAR(rig.state.significant_N, 1.01, 1e-12);
  for (int i = 0; i < 2000; ++i) rig.read(i % 2 == 0 ? 0.0 : 50.0, 0.2);
  EXPECT_NEAR(rig.state.significant_N, 10.0 * kS_min_N, 1e-12) << "more would be no sensor";
}

/// A difference larger than the noise, as a force, is followed by its square.
TEST(SmootherSteps, FollowWhatIsNoNoise) {
  SmootherRig rig;
  for (int i = 0; i < 400; ++i) rig.read(4.0, 0.2);
  const double weight = rig.state.weight * kFading;
  rig.read(4.0, 0.24);  // by a fifth of half a length: 0.8 N
  const double slow = 16.0 / (weight + 16.0);
  const double share = 1.0 - (1.0 - slow) * std::pow(kS_min_N / 0.8, 2.0);
  EXPECT_NEAR(rig.state.contact.position_m, 0.2 + share * 0.04, 1e-6);
}

}  // namespace
}  // namespace tactus
