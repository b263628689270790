#include <gtest/gtest.h>

#include <cmath>

#include "tactus/control/contact_smoother.h"
#include "tactus/control/stiffness_centre.h"

/// The equations of stiffness_centre.h by hand, reading by reading, of a link that stands still.
namespace tactus {
namespace {

constexpr double kModule_m = 0.4;
constexpr double kModuleRadius_m = 0.06;
constexpr double kNoise_N = 0.2;

/// Readings of a force along y.
struct CentreRig {
  explicit CentreRig(double friction = 0.0, double noise_N = kNoise_N)
      : centre(
            [] {
              TactileModuleConfig module;
              module.length_m = kModule_m;
              module.cover_radius_m = kModuleRadius_m;
              return module;
            }(),
            friction) {
    smoother.significant_N = noise_N;
    smoother.contact = {5.0, 0.2, Vector3::UnitY(), 0.0};
    smoother.X_BaseModule.R_AB.setIdentity();
    smoother.X_BaseModule.p_AB.setZero();
  }
  void read(double force_N, double position_m, double interval_s = 0.004) {
    smoother.contact.force_N = force_N;
    centre.update({}, {force_N, position_m, Vector3::UnitY(), interval_s}, smoother, state);
  }
  double learnt_m() const { return state.p_Base.x(); }

  StiffnessCentre centre;
  ContactSmootherState smoother;
  StiffnessCentreState state;
};

TEST(StiffnessCentreSteps, BeginWithAReference) {
  CentreRig rig;
  rig.read(5.0, 0.3);
  EXPECT_TRUE(rig.state.has_reference);
  EXPECT_EQ(rig.state.F_BaseRef, Vector3(0.0, 5.0, 0.0));
  EXPECT_LT((rig.state.p_BaseRef - Vector3(0.3, -kModuleRadius_m, 0.0)).norm(), 1e-15)
      << "on the cover, where the contact is";
  EXPECT_EQ(rig.state.weight, 0.0);
  EXPECT_EQ(rig.state.shift_m, 0.0);
}

/// More than the noise, and more than a tenth of the force, which is sliding.
TEST(StiffnessCentreSteps, LearnOfChangesThatMeanSomething) {
  for (const double noise_N : {kNoise_N, 1.0}) {
    const double least_N = noise_N < 0.5 ? 5.0 / 9.0 : 1.0;
    CentreRig rig(0.0, noise_N);
    rig.read(5.0, 0.2);
    rig.read(5.0 + 0.99 * least_N, 0.25);
    EXPECT_EQ(rig.state.weight, 0.0) << noise_N;
    rig.read(5.0 + 1.01 * least_N, 0.2);
    EXPECT_NEAR(rig.state.weight, std::pow(1.01 * least_N, 2.0), 1e-12) << noise_N;
  }
  CentreRig exactly(0.0, 1.0);
  exactly.read(5.0, 0.2);
  exactly.read(6.0, 0.25);
  EXPECT_EQ(exactly.state.weight, 0.0) << "it may all be noise";
  CentreRig falling;
  falling.read(5.0, 0.2);
  falling.read(3.0, 0.2);
  EXPECT_NEAR(falling.state.weight, 4.0, 1e-12) << "less force tells as much";
}

/// However little is known yet.
TEST(StiffnessCentreSteps, WeighSmallChangesLikewise) {
  CentreRig rig;
  rig.read(2.0, 0.1);
  rig.read(2.6, 0.32 / 2.6);  // 0.6 N more at 0.2 m
  EXPECT_NEAR(rig.learnt_m(), 0.2, 1e-12);
  rig.read(3.2, 0.56 / 3.2);  // and as much at 0.4 m
  EXPECT_NEAR(rig.learnt_m(), 0.3, 1e-12);
}

TEST(StiffnessCentreSteps, CountForcesAlongTheSmoothedDirection) {
  CentreRig rig;
  rig.read(2.0, 0.1);
  rig.centre.update({}, {5.0, 0.2, Vector3(0.0, 0.8, 0.6), 0.004}, rig.smoother, rig.state);
  EXPECT_NEAR(rig.state.weight, 4.0, 1e-12);
}

TEST(StiffnessCentreSteps, ReplaceAReadingOnceItIsExactlyASecondOld) {
  CentreRig rig;
  rig.read(5.0, 0.2, 0.25);
  for (int i = 0; i < 3; ++i) rig.read(5.1, 0.2, 0.25);
  EXPECT_EQ(rig.state.F_BaseRef.y(), 5.0);
  rig.read(5.1, 0.2, 0.25);
  EXPECT_EQ(rig.state.F_BaseRef.y(), 5.1);
  EXPECT_EQ(rig.state.since_s, 0.0);
}

/// x = dM / dF, and the mean weighs by dF^2.
TEST(StiffnessCentreSteps, FindWhereTheChangeActs) {
  CentreRig rig;
  rig.read(2.0, 0.1);
  rig.read(4.0, 0.2);  // 2 N more at 0.3 m
  EXPECT_NEAR(rig.learnt_m(), 0.3, 1e-12);
  EXPECT_EQ(rig.state.F_BaseRef, Vector3(0.0, 4.0, 0.0)) << "the next change is from here";
  EXPECT_EQ(rig.state.since_s, 0.0);
  rig.read(5.0, 0.18);  // 1 N more at 0.1 m
  const double before = std::min(4.0, 30.0 * kNoise_N * kNoise_N);
  EXPECT_NEAR(rig.state.weight, before + 1.0, 1e-12);
  EXPECT_NEAR(rig.learnt_m(), 0.3 + (0.1 - 0.3) / (before + 1.0), 1e-12);
}

TEST(StiffnessCentreSteps, StayOnTheCover) {
  CentreRig high, low;
  high.read(2.0, 0.1);
  high.read(3.0, 0.3);  // 1 N more at 0.7 m
  EXPECT_NEAR(high.learnt_m(), kModule_m, 1e-15);
  low.read(2.0, 0.3);
  low.read(3.0, 0.1);
  EXPECT_NEAR(low.learnt_m(), 0.0, 1e-15);
}

TEST(StiffnessCentreSteps, ReplaceAReadingThatIsASecondOld) {
  CentreRig rig;
  rig.read(5.0, 0.2);
  for (int i = 0; i < 249; ++i) rig.read(5.1, 0.25);
  EXPECT_EQ(rig.state.F_BaseRef.y(), 5.0);
  for (int i = 0; i < 2; ++i) rig.read(5.1, 0.25);
  EXPECT_EQ(rig.state.F_BaseRef.y(), 5.1);
  EXPECT_EQ(rig.state.weight, 0.0) << "slow changes teach nothing";
}

TEST(StiffnessCentreSteps, BeginAnewBelowTheThreshold) {
  CentreRig rig;
  rig.read(5.0, 0.2);
  rig.read(1.2, 0.2);
  EXPECT_FALSE(rig.state.has_reference);
  rig.read(3.0, 0.1);
  EXPECT_EQ(rig.state.weight, 0.0);
  EXPECT_EQ(rig.state.F_BaseRef.y(), 3.0);
}

/// A centimetre, mu r, and half a length times s / sqrt W are no second contact, to either side.
TEST(StiffnessCentreSteps, DoubtWhatIsNearTheContact) {
  for (const double mu : {0.0, 0.5}) {
    CentreRig rig(mu);
    rig.state.weight = 1.0;
    const double doubt_m = 0.01 + mu * kModuleRadius_m + 0.5 * kModule_m * kNoise_N;
    const auto shiftTo = [&](double centre_m) {
      rig.state.p_Base = Vector3(centre_m, -kModuleRadius_m, 0.0);
      rig.read(1.0, 0.2);  // teaches nothing
      return rig.state.shift_m;
    };
    EXPECT_NEAR(shiftTo(0.2 + doubt_m + 0.05), 0.05, 1e-12) << mu;
    EXPECT_NEAR(shiftTo(0.2 - doubt_m - 0.05), -0.05, 1e-12) << mu;
    EXPECT_EQ(shiftTo(0.2 + 0.99 * doubt_m), 0.0);
    EXPECT_EQ(shiftTo(0.2 - 0.99 * doubt_m), 0.0);
    EXPECT_NEAR(shiftTo(9.0), kModule_m - 0.2 - doubt_m, 1e-12) << "no further than the cover";
    EXPECT_NEAR(shiftTo(-9.0), -0.2 + doubt_m, 1e-12);
  }
}

}  // namespace
}  // namespace tactus
