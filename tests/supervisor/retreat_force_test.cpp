#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "support/retreat_run.h"

/// What remains of a contact after a tactile fault: any posture, post or band, with friction,
/// masses and gears, and noise of 0.05 N.
namespace tactus {
namespace {

using test::Random;
using test::RetreatArm;
using test::SampleTrouble;
using test::touchingScene;

constexpr double kMaxForce_N = 5.0;  ///< F_act + F_th of the scenes
constexpr double kNoise_N = 0.05;
constexpr double kFriction = 0.3;
/// Stiffness down to which the way out without readings suffices, with a fifth for friction: an
/// eighth of what the scene assumes.
constexpr double kAsAssumed_N_per_m = 1.2 * 7000.0 / 8.0;

struct Setting {
  const char* scene;
  const char* variant;
  const char* arm;
};

struct RetreatOutcome {
  double at_fault_N = 0.0;
  double after_1s_N = 0.0, after_2s_N = 0.0;
  double stiffness_N_per_m = 0.0;  ///< of the contact
  double way_m = 0.0;
};

double contactStiffness(const Scene& scene) {
  return inSeries(scene.plant.obstacles.front().stiffness_N_per_m,
                  scene.plant.robot_stiffness_N_per_m);
}

/// Nothing where there was no contact, or no such force. The trouble comes so long after it.
std::optional<RetreatOutcome> meet(const Scene& scene, std::uint64_t seed, SampleTrouble trouble,
                                   double at_N, double after_s = 0.0) {
  RetreatArm arm(scene, seed);
  arm.noise_N = kNoise_N;
  const auto has_left = [&] { return arm.mode() != Mode::kRunning; };
  if (!arm.runUntil(6.0, [&] { return has_left() || arm.force_N() > at_N; })) return {};
  if (after_s > 0.0) {
    arm.run(after_s);
    if (has_left()) return {};
  }
  arm.trouble = trouble;
  if (!arm.runUntil(0.1, has_left)) return {};
  RetreatOutcome outcome{.at_fault_N = arm.force_N(), .stiffness_N_per_m = contactStiffness(scene)};
  arm.run(1.0);
  outcome.after_1s_N = arm.force_N();
  arm.run(1.0);
  outcome.after_2s_N = arm.force_N();
  outcome.way_m = arm.state().retreat.way;
  EXPECT_EQ(arm.mode(), Mode::kHolding);
  EXPECT_TRUE(arm.output().velocity.isZero(0.0));
  return outcome;
}

/// `check` of so many cases, of which each has met something.
template <typename Check>
void forCases(const Setting& setting, std::uint64_t seed, int count, SampleTrouble trouble,
              const Check& check) {
  Random random(seed);
  double worst_N = 0.0, worst_stiff_N = 0.0, worst_fault_N = 0.0;
  int met = 0;
  for (int tried = 0; met < count; ++tried) {
    ASSERT_LT(tried, 6 * count) << "hardly any case meets anything";
    Scene scene =
        touchingScene(random, setting.scene,
                      {{"controller.variant", setting.variant}, {"simulation.arm", setting.arm}});
    scene.plant.obstacles.front().friction_coefficient = kFriction;
    const double at_N = trouble == SampleTrouble::kNone ? kNoLimit : random.uniform(3.0, 60.0);
    const std::optional<RetreatOutcome> outcome = meet(scene, seed + tried, trouble, at_N);
    if (!outcome) continue;
    ++met;
    SCOPED_TRACE(std::string(setting.scene) + ", " + setting.arm + ", case " +
                 std::to_string(tried));
    check(*outcome);
    worst_N = std::max({worst_N, outcome->after_1s_N, outcome->after_2s_N});
    worst_fault_N = std::max(worst_fault_N, outcome->at_fault_N);
    if (outcome->stiffness_N_per_m > kAsAssumed_N_per_m)
      worst_stiff_N = std::max(worst_stiff_N, outcome->after_1s_N);
  }
  std::printf(
      "%s, %s, trouble %d: %d contacts, up to %.0f N at the fault, %.2f N remain, "
      "%.2f N of those as stiff as assumed\n",
      setting.scene, setting.arm, static_cast<int>(trouble), met, worst_fault_N, worst_N,
      worst_stiff_N);
}

constexpr Setting kUnyielding[] = {{"scenario1_none", "none", "quasi_static"},
                                   {"scenario1_none", "none", "rigid_gears"},
                                   {"scenario1_none", "none", "flexible_gears"},
                                   {"robots/kuka_iiwa7_contact", "none", "quasi_static"}};

TEST(RetreatForce, AfterTooMuchForceLeavesLessThanTheLawsForce) {
  for (const Setting& setting : kUnyielding) {
    forCases(setting, 1000, 40, SampleTrouble::kNone, [](const RetreatOutcome& outcome) {
      EXPECT_LE(outcome.after_1s_N, kMaxForce_N);
      EXPECT_LE(outcome.after_2s_N, kMaxForce_N);
      const double depth_m = std::max(100.0, outcome.at_fault_N) / outcome.stiffness_N_per_m;
      EXPECT_LE(outcome.way_m, 1.25 * depth_m + 0.05) << "no longer than needed";
    });
  }
}

/// Without readings: nothing of contacts down to an eighth of the stiffness that is assumed, and
/// of softer ones no more than there was.
TEST(RetreatForce, WithoutReadingsLeavesNothingOfContactsAsAssumed) {
  for (const SampleTrouble trouble : {SampleTrouble::kSilent, SampleTrouble::kNotANumber,
                                      SampleTrouble::kSaturated, SampleTrouble::kCableBreak}) {
    for (const int i : {0, 2}) {
      const std::uint64_t seed = 2000 + 100 * static_cast<std::uint64_t>(trouble);
      forCases(kUnyielding[i], seed, 15, trouble, [](const RetreatOutcome& outcome) {
        const bool is_as_assumed = outcome.stiffness_N_per_m > kAsAssumed_N_per_m;
        EXPECT_LE(outcome.after_1s_N, is_as_assumed ? kMaxForce_N : outcome.at_fault_N);
        EXPECT_LE(outcome.after_2s_N, is_as_assumed ? kMaxForce_N : outcome.at_fault_N);
        EXPECT_LE(outcome.way_m, 0.101);
      });
    }
  }
}

/// Laws that estimate swing in contacts: the last sample may be one of the filter's, of the other
/// side, or one that does not tell yet of where the arm is.
TEST(RetreatForce, WithoutReadingsLeavesNothingWhereALawSwings) {
  for (const char* variant : {"null_task", "null_joint", "task_space", "null_limit"}) {
    Random random(700);
    int met = 0;
    double worst_N = 0.0;
    for (int tried = 0; tried < 200 && met < 40; ++tried) {
      Scene scene =
          touchingScene(random, "scenario3_estimated",
                        {{"controller.variant", variant}, {"simulation.arm", "flexible_gears"}});
      scene.plant.obstacles.front().friction_coefficient = kFriction;
      const double after_s = random.chance(0.7) ? random.uniform(0.0, 0.5) : 0.0;
      const double at_N = after_s > 0.0 ? 3.0 : random.uniform(3.0, 20.0);
      const std::optional<RetreatOutcome> outcome =
          meet(scene, 700 + tried, SampleTrouble::kSilent, at_N, after_s);
      if (!outcome) continue;
      ++met;
      const double at_most_N = outcome->stiffness_N_per_m > kAsAssumed_N_per_m
                                   ? kMaxForce_N
                                   : std::max(kMaxForce_N, outcome->at_fault_N);
      EXPECT_LE(outcome->after_1s_N, at_most_N) << variant << ", case " << tried;
      worst_N = std::max(worst_N, outcome->after_1s_N);
    }
    std::printf("%s: %d contacts, %.2f N remain\n", variant, met, worst_N);
    EXPECT_EQ(met, 40);
  }
}

/// Three joints cannot move further, to one side or the other.
TEST(RetreatForce, WhereJointsAreAtTheirLimits) {
  Random random(3000);
  int met = 0;
  double worst_N = 0.0;
  for (int tried = 0; tried < 200 && met < 30; ++tried) {
    Scene scene = touchingScene(random, "scenario1_none", {{"simulation.arm", "quasi_static"}});
    ControllerConfig& config = scene.controller;
    const int n = config.chain.size();
    for (int k = 0; k < 3; ++k) {
      const int joint = random.index(n);
      // The present place becomes the limit: the posture, and so the contact, stays.
      (random.chance(0.5) ? config.limits.upper : config.limits.lower)[joint] =
          config.q_start[joint];
    }
    const std::optional<RetreatOutcome> outcome =
        meet(scene, 3000 + tried, SampleTrouble::kNone, kNoLimit);
    if (!outcome) continue;
    ++met;
    EXPECT_LE(outcome->after_1s_N, kMaxForce_N) << tried;
    worst_N = std::max(worst_N, outcome->after_1s_N);
  }
  std::printf("joints at limits: %d contacts, %.2f N remain\n", met, worst_N);
  EXPECT_GE(met, 30);
}

/// null_limit yields to what comes towards it, with a force beyond its own.
TEST(RetreatForce, FromObstaclesThatComeTowardsTheArm) {
  Random random(5000);
  int met = 0;
  double worst_N = 0.0;
  for (int tried = 0; tried < 200 && met < 20; ++tried) {
    Scene scene =
        touchingScene(random, "scenario1_none",
                      {{"controller.variant", "null_limit"}, {"simulation.arm", "quasi_static"}});
    ControllerConfig& config = scene.controller;
    config.tactile_modules.front().max_force_N = 25.0;
    ObstacleConfig& post = scene.plant.obstacles.front();
    post.stiffness_N_per_m = 1e5;
    const Vector3 aside = config.task.trajectory.waypoints.front().displacement_m / 0.4;
    config.task.trajectory.waypoints.clear();
    post.swing = {.x_m = -0.12 * aside.x(), .y_m = -0.12 * aside.y(), .frequency_hz = 0.2};
    RetreatArm arm(scene, 5000 + tried);
    arm.noise_N = kNoise_N;
    if (!arm.runUntil(1.0, [&] { return arm.mode() == Mode::kRetreating; })) continue;
    ++met;
    arm.run(0.3);
    for (int i = 0; i < 700; ++i) {
      arm.step();
      worst_N = std::max(worst_N, arm.force_N());
    }
    EXPECT_EQ(arm.fault(), Fault::kTactileInvalid);
  }
  std::printf("obstacles at up to 0.15 m/s: %d, then at most %.1f N\n", met, worst_N);
  EXPECT_GE(met, 20);
  constexpr double kLate_s = 0.05;  // sensor and ramp, whenever it is there again
  EXPECT_LE(worst_N, 7000.0 * 0.15 * kLate_s);
}

}  // namespace
}  // namespace tactus
