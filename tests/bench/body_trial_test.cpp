#include "tactus/bench/body_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "support/crops9.h"
#include "support/tactile_samples.h"

namespace tactus {
namespace {

RunSetup bodyBase() {
  return {test::crops9Controller(Variant::kNullTask, true), test::crops9Plant(test::scenario2())};
}

BodyRegion regionNamed(const std::string& name) {
  for (const BodyRegion& region : bodyRegions())
    if (region.name == name) return region;
  throw std::invalid_argument(name);
}

TEST(BodyRegions, AreTwelveWithTwentyNineAreas) {
  int areas = 0;
  std::set<std::string> names;
  for (const BodyRegion& region : bodyRegions()) {
    areas += region.areas;
    EXPECT_TRUE(names.insert(region.name).second);
    EXPECT_GE(region.max_force_N, 65.0);
    EXPECT_LE(region.max_force_N, 220.0);
    EXPECT_GE(region.stiffness_N_per_m, 10e3);
    EXPECT_LE(region.stiffness_N_per_m, 150e3);
  }
  EXPECT_EQ(names.size(), 12u);
  EXPECT_EQ(areas, 29);
}

TEST(BodyTrial, MeetsTheRegionWithTheSpeedThatItNames) {
  for (const double speed_m_per_s : {0.1, 0.5}) {
    const BodyTrial trial{Variant::kNone, regionNamed("abdomen"), speed_m_per_s};
    const RunSetup setup = bodySetup(bodyBase(), trial);
    EXPECT_NEAR(judgeRun(setup).touch_speed_m_per_s, speed_m_per_s, 0.01 * speed_m_per_s);
  }
}

TEST(BodyTrial, WithoutALawTheArmPressesBeyondAnyLimit) {
  const BodyTrial trial{Variant::kNone, regionNamed("abdomen"), 0.1};
  EXPECT_GT(judgeRun(bodySetup(bodyBase(), trial)).peak_true_force_N, 5.0 * 110.0);
}

TEST(BodyTrial, TheLimitedLawComesToRestNearItsForce) {
  const RunSetup base = bodyBase();
  const ForceGains& force = base.controller.gains.force;
  const double limit_N = force.activation_force_N + force.contact_threshold_N;
  for (const char* name : {"abdomen", "skull and forehead"}) {
    const BodyTrial trial{Variant::kNullLimit, regionNamed(name), 0.2};
    const JudgedRun run = judgeRun(bodySetup(base, trial));
    EXPECT_GT(run.peak_true_force_N, limit_N);
    EXPECT_NEAR(run.peak_at_rest_N, limit_N, 0.1 * limit_N) << name;
  }
}

TEST(BodyTrial, AStifferRegionIsHitHarder) {
  double before_N = 0.0;
  for (const char* name : {"abdomen", "chest", "lower legs", "skull and forehead"}) {
    const BodyTrial trial{Variant::kNullLimit, regionNamed(name), 0.1};
    const double peak_N = judgeRun(bodySetup(bodyBase(), trial)).peak_true_force_N;
    EXPECT_GT(peak_N, before_N) << name;
    before_N = peak_N;
  }
}

TEST(BodyTrial, AFreeBlowIsThatOfBothMassesInSeries) {
  const BodyTrial trial{Variant::kNullLimit, regionNamed("neck"), 0.3};
  RunSetup setup = bodySetup(bodyBase(), trial);
  JudgedRun run;
  run.touch_speed_m_per_s = 0.3;
  EXPECT_TRUE(std::isnan(freeBlow_N(setup, trial, run))) << "an arm without mass";
  run.touch_mass_kg = 1.2;  // as much as the neck: half of it
  EXPECT_NEAR(freeBlow_N(setup, trial, run), 0.3 * std::sqrt(50e3 * 0.6), 1e-9);
  setup.plant.robot_stiffness_N_per_m = 50e3;
  EXPECT_NEAR(freeBlow_N(setup, trial, run), 0.3 * std::sqrt(25e3 * 0.6), 1e-9);
}

}  // namespace
}  // namespace tactus
