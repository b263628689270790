#include <gtest/gtest.h>

#include <numbers>

#include "support/controller_run.h"
#include "support/period.h"

/// What a controller takes for the contact that it shall leave.
namespace tactus {
namespace {

constexpr int kSkinModules = 3;

ControllerConfig skinOf(Variant variant, bool has_estimator, int modules) {
  test::Random random(2301);
  ControllerConfig config = test::fullController(random, 7, variant);
  config.force_control->has_estimator = has_estimator;
  while (static_cast<int>(config.tactile_modules.size()) < modules)
    config.tactile_modules.push_back(config.tactile_modules.front());
  config.drive_lag_s = 0.006;
  return config;
}

ContactPointState pushOf(double force_N, double position_m) {
  return {force_N, position_m, Vector3::UnitY(), 0.0};
}

/// A controller and a state that a test makes up.
struct Struck {
  explicit Struck(const ControllerConfig& c) : config(c), controller(c) {}
  const RetreatState& begin() {
    controller.beginRetreat(config.gains, state);
    return state.retreat;
  }

  ControllerConfig config;
  Controller controller;
  ControllerState state = controller.initialState();
};

Struck struckSkin() { return Struck(skinOf(Variant::kNullLimit, false, kSkinModules)); }

TEST(RetreatBegin, IsOfTheModuleThatPressesMost) {
  for (int most = 0; most < kSkinModules; ++most) {
    Struck arm = struckSkin();
    for (int i = 0; i < kSkinModules; ++i)
      arm.state.modules[i].hardest = pushOf(i == most ? 7.0 : 3.0, 0.1 * (i + 1));
    const RetreatState& retreat = arm.begin();
    EXPECT_TRUE(retreat.has_push);
    EXPECT_EQ(retreat.module, most);
    EXPECT_EQ(retreat.push.force_N, 7.0);
    EXPECT_EQ(retreat.push.position_m, 0.1 * (most + 1));
  }
}

TEST(RetreatBegin, TakesNoPushThatIsNoContact) {
  Struck arm = struckSkin();
  arm.state.modules[1].hardest = pushOf(arm.config.gains.force.contact_threshold_N, 0.2);
  EXPECT_FALSE(arm.begin().has_push);
  EXPECT_EQ(arm.state.retreat.module, -1);
  arm.state.modules[1].hardest.force_N *= 1.001;
  EXPECT_TRUE(arm.begin().has_push);
  arm.config.gains.force.contact_threshold_N = 0.0;  // below 0.05 N there is no direction
  arm.state.modules[1].hardest.force_N = 0.05;
  EXPECT_FALSE(arm.begin().has_push);
  arm.state.modules[1].hardest.force_N = 0.051;
  EXPECT_TRUE(arm.begin().has_push);
}

/// A reading beyond the range tells of a contact where nothing was felt before it.
TEST(RetreatBegin, TakesAnExcessForWhatWasNotFeltBefore) {
  Struck arm = struckSkin();
  TactileReading& reading = arm.state.modules[2];
  reading.excess = pushOf(400.0, 0.3);
  EXPECT_FALSE(arm.begin().has_push) << "an excess of long ago";
  reading.fault = Fault::kTactileInvalid;
  EXPECT_FALSE(arm.begin().has_push) << "no number";
  reading.has_excess = true;
  EXPECT_EQ(arm.begin().push.force_N, 400.0);
  reading.fault = Fault::kNone;
  EXPECT_FALSE(arm.begin().has_push) << "it is over";
  reading.fault = Fault::kTactileInvalid;
  reading.hardest = pushOf(arm.config.gains.force.contact_threshold_N, 0.1);
  EXPECT_EQ(arm.begin().push.force_N, 400.0) << "that was none yet";
  reading.hardest = pushOf(2.0, 0.1);
  EXPECT_EQ(arm.begin().push.position_m, 0.1) << "where a contact was felt before it";
}

/// Age of the sample, filter, drives, and until a sample is read.
TEST(RetreatBegin, KnowsHowLateASampleTells) {
  Struck arm = struckSkin();
  arm.config.tactile_modules[1].filter_cutoff_hz = 20.0;
  Struck other(arm.config);
  other.state.modules[1].hardest = pushOf(5.0, 0.2);
  other.state.modules[1].age_s = 0.012;
  EXPECT_NEAR(other.begin().untold_s, 0.012 + 2.0 / (2.0 * std::numbers::pi * 20.0) + 0.006 + 0.005,
              1e-12);
}

/// An eighth of what is assumed; of an estimate half, if that is less.
TEST(RetreatBegin, TakesAContactForAsSoftAsItMayBe) {
  for (const bool has_estimator : {false, true}) {
    Struck arm(skinOf(Variant::kNullSpace, has_estimator, 1));
    const double assumed = arm.config.gains.force.assumed_stiffness_N_per_m;
    arm.state.modules[0].hardest = pushOf(5.0, 0.2);
    EXPECT_EQ(arm.begin().stiffness_N_per_m, assumed / 8.0);
    arm.state.contact.estimator.stiffness_N_per_m = assumed / 5.0;
    EXPECT_EQ(arm.begin().stiffness_N_per_m, has_estimator ? assumed / 10.0 : assumed / 8.0);
    arm.state.contact.estimator.stiffness_N_per_m = assumed;
    EXPECT_EQ(arm.begin().stiffness_N_per_m, assumed / 8.0);
    arm.state.contact.estimator.stiffness_N_per_m = 0.9;
    EXPECT_EQ(arm.begin().stiffness_N_per_m, has_estimator ? 0.45 : assumed / 8.0);
  }
  Struck limit(skinOf(Variant::kNullLimit, true, 1));
  limit.state.modules[0].hardest = pushOf(5.0, 0.2);
  limit.state.contact.approach.estimator.stiffness_N_per_m = 200.0;
  EXPECT_EQ(limit.begin().stiffness_N_per_m, 100.0);
  Struck several(skinOf(Variant::kNullLimit, true, 2));
  several.state.modules[1].hardest = pushOf(5.0, 0.2);
  several.state.several.modules[0].approach.estimator.stiffness_N_per_m = 20.0;
  several.state.several.modules[1].approach.estimator.stiffness_N_per_m = 300.0;
  EXPECT_EQ(several.begin().stiffness_N_per_m, 150.0) << "each module has its own";
}

/// Nobody felt anything: back the way it came, for as long as something may have been untold.
TEST(RetreatBegin, GoesBackWhereNothingWasFelt) {
  Struck arm = struckSkin();
  const double late_s = 1.0 / (std::numbers::pi * 15.0) + 0.006 + 0.005;
  arm.state.velocity_before.setConstant(0.1);
  arm.state.modules[1].age_s = 0.02;
  arm.state.modules[2].age_s = 0.1;
  arm.state.modules[2].is_lost = true;
  EXPECT_FALSE(arm.begin().is_over);
  EXPECT_NEAR(arm.state.retreat.way_to, 0.02 + late_s, 1e-12) << "a lost one tells nothing";
  arm.state.modules[2].is_lost = false;
  EXPECT_NEAR(arm.begin().way_to, 0.1 + late_s, 1e-12);
  arm.state.modules[0].age_s = 3.0;
  EXPECT_EQ(arm.begin().way_to, 0.25) << "no longer than that";
}

TEST(RetreatBegin, OfAnArmThatStoodIsOver) {
  Struck arm = struckSkin();
  arm.state.velocity_before.setConstant(0.9e-6);
  EXPECT_TRUE(arm.begin().is_over);
  arm.state.velocity_before[3] = -1.1e-6;
  EXPECT_FALSE(arm.begin().is_over);
  arm.state.velocity_before.setZero();
  arm.state.modules[0].hardest = pushOf(5.0, 0.2);
  EXPECT_FALSE(arm.begin().is_over) << "it leaves what it felt";
}

/// By the motion that it had, not by what was left of it when the mode changed.
TEST(RetreatBegin, RemembersTheVelocityOfTheFault) {
  Struck arm = struckSkin();
  arm.state.velocity_before.setConstant(0.2);
  EXPECT_EQ(arm.begin().velocity_at_fault, arm.state.velocity_before);
  arm.state.fault = Fault::kTactileStale;
  arm.state.velocity_before.setConstant(0.1);
  EXPECT_EQ(arm.begin().velocity_at_fault, JointVector(JointVector::Constant(7, 0.2)));
}

/// An arm that has left its path comes back to it gently, one that has not, and leans on something,
/// goes on.
TEST(RetreatBegin, MakesForAGentleReturnOnceItHasMoved) {
  Struck arm = struckSkin();
  arm.state.retreat.is_under_way = arm.state.has_leaned = true;
  arm.state.modules[0].contact = pushOf(5.0, 0.2);
  arm.controller.goOn(arm.config.gains, arm.state);
  EXPECT_FALSE(arm.state.retreat.is_under_way);
  EXPECT_EQ(arm.state.return_share, 1.0);
  arm.state.retreat.has_moved = true;
  arm.begin();
  EXPECT_TRUE(arm.state.retreat.has_moved) << "by an earlier one";
  const JointVector q = arm.state.q_desired;
  arm.state.velocity_before.setConstant(0.1);
  arm.controller.goOn(arm.config.gains, arm.state);
  EXPECT_FALSE(arm.state.retreat.has_moved);
  EXPECT_EQ(arm.state.return_share, 0.0);
  EXPECT_EQ(arm.state.q_desired, q);
  EXPECT_TRUE(arm.state.velocity_before.isZero(0.0));
}

}  // namespace
}  // namespace tactus
