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

struct Outcome {
  double at_fault_N = 0.0;
  double after_1s_N = 0.0, after_2s_N = 0.0;
  double stiffness_N_per_m = 0.0;  ///< of the contact
  double way_m = 0.0;
};

double contactStiffness(const Scene& scene) {
  return inSeries(scene.plant.obstacles.front().stiffness_N_per_m,
                  scene.plant.robot_stiffness_N_per_m);
}

/// Nothing where there was no contact, or no such force.
std::optional<Outcome> meet(const Scene& scene, std::uint64_t seed, SampleTrouble trouble,
                            double at_N) {
  RetreatArm arm(scene, seed);
  arm.noise_N = kNoise_N;
  const auto has_left = [&] { return arm.mode() != Mode::kRunning; };
  if (!arm.runUntil(6.0, [&] { return has_left() || arm.force_N() > at_N; })) return {};
  arm.trouble = trouble;
  if (!arm.runUntil(0.1, has_left)) return {};
  Outcome outcome{.at_fault_N = arm.force_N(), .stiffness_N_per_m = contactStiffness(scene)};
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
    const std::optional<Outcome> outcome = meet(scene, seed + tried, trouble, at_N);
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

TEST(Retreat, AfterTooMuchForceLeavesLessThanTheLawsForce) {
  for (const Setting& setting : kUnyielding) {
    forCases(setting, 1000, 40, SampleTrouble::kNone, [](const Outcome& outcome) {
      EXPECT_LE(outcome.after_1s_N, kMaxForce_N);
      EXPECT_LE(outcome.after_2s_N, kMaxForce_N);
      const double depth_m = std::max(100.0, outcome.at_fault_N) / outcome.stiffness_N_per_m;
      EXPECT_LE(outcome.way_m, 1.25 * depth_m + 0.05) << "no longer than needed";
    });
  }
}

/// Without readings: nothing of contacts down to an eighth of the stiffness that is assumed, and
/// of softer ones no more than there was.
TEST(Retreat, WithoutReadingsLeavesNothingOfContactsAsAssumed) {
  for (const SampleTrouble trouble : {SampleTrouble::kSilent, SampleTrouble::kNotANumber,
                                      SampleTrouble::kSaturated, SampleTrouble::kCableBreak}) {
    for (const int i : {0, 2}) {
      const std::uint64_t seed = 2000 + 100 * static_cast<std::uint64_t>(trouble);
      forCases(kUnyielding[i], seed, 15, trouble, [](const Outcome& outcome) {
        const bool is_as_assumed = outcome.stiffness_N_per_m > kAsAssumed_N_per_m;
        EXPECT_LE(outcome.after_1s_N, is_as_assumed ? kMaxForce_N : outcome.at_fault_N);
        EXPECT_LE(outcome.after_2s_N, is_as_assumed ? kMaxForce_N : outcome.at_fault_N);
        EXPECT_LE(outcome.way_m, 0.101);
      });
    }
  }
}

/// Three joints cannot move further, to one side or the other.
TEST(Retreat, WhereJointsAreAtTheirLimits) {
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
    const std::optional<Outcome> outcome =
        meet(scene, 3000 + tried, SampleTrouble::kNone, kNoLimit);
    if (!outcome) continue;
    ++met;
    EXPECT_LE(outcome->after_1s_N, kMaxForce_N) << tried;
    worst_N = std::max(worst_N, outcome->after_1s_N);
  }
  std::printf("joints at limits: %d contacts, %.2f N remain\n", met, worst_N);
  EXPECT_GE(met, 30);
}

/// An arm that the shipped scene's path leads on, past a contact or without one.
RetreatArm runningArm(const std::vector<Override>& overrides, double duration_s) {
  RetreatArm arm(test::shippedScene("scenario1_none", overrides), 1);
  arm.run(duration_s);
  EXPECT_EQ(arm.mode(), Mode::kRunning);
  return arm;
}

/// The largest way of any joint, m or rad.
double wayOf(RetreatArm& arm, double duration_s) {
  const JointVector q = arm.output().q_desired;
  arm.run(duration_s);
  return (arm.output().q_desired - q).cwiseAbs().maxCoeff();
}

TEST(Retreat, WithoutAContactHardlyMovesTheArm) {
  for (const SampleTrouble trouble :
       {SampleTrouble::kSilent, SampleTrouble::kNotANumber, SampleTrouble::kSaturated,
        SampleTrouble::kCableBreak, SampleTrouble::kStuckExcess}) {
    RetreatArm arm = runningArm({}, 3.0);
    ASSERT_LT(arm.force_N(), 0.01);
    arm.trouble = trouble;
    const double way = wayOf(arm, 3.0);
    EXPECT_EQ(arm.mode(), Mode::kHolding);
    EXPECT_LE(way, trouble == SampleTrouble::kStuckExcess ? 0.15 : 0.02)
        << static_cast<int>(trouble);
    EXPECT_LE(arm.state().retreat.way, 0.06) << "m of the contact point, or s of the way back";
  }
}

TEST(Retreat, OfAnArmThatStandsStillIsNone) {
  RetreatArm arm = runningArm({}, 0.2);  // before its path begins
  arm.trouble = SampleTrouble::kSilent;
  EXPECT_LE(wayOf(arm, 2.0), 1e-6);
  EXPECT_EQ(arm.mode(), Mode::kHolding);
}

/// In a contact of 10 N, just when it begins to leave it.
RetreatArm retreatingArm() {
  Scene scene = test::shippedScene("scenario1_none");
  scene.controller.tactile_modules.front().max_force_N = 10.0;
  RetreatArm arm(scene, 1);
  EXPECT_TRUE(arm.runUntil(12.0, [&] { return arm.mode() == Mode::kRetreating; }));
  arm.run(0.02);
  EXPECT_EQ(arm.mode(), Mode::kRetreating);
  EXPECT_GT(arm.force_N(), 8.0);
  return arm;
}

TEST(Retreat, EndsAtOnceByHarsherFaultsAndTheEnableLine) {
  const RetreatArm retreating = retreatingArm();
  const std::pair<Fault, Mode> faults[] = {{Fault::kOverrun, Mode::kStopping},
                                           {Fault::kForbiddenSystemCall, Mode::kStopping},
                                           {Fault::kEmergencyStop, Mode::kFault},
                                           {Fault::kDriveFault, Mode::kFault},
                                           {Fault::kNone, Mode::kHolding}};
  for (const auto& [fault, mode] : faults) {
    RetreatArm arm = retreating;
    arm.extra_fault = fault;
    arm.enable = fault != Fault::kNone;
    arm.step();
    EXPECT_EQ(arm.mode(), mode) << faultName(fault);
    arm.run(0.02);
    EXPECT_TRUE(arm.output().velocity.isZero(0.0)) << faultName(fault);
    EXPECT_LE(wayOf(arm, 1.0), 1e-4) << faultName(fault);  // drives that stop by themselves lag
  }
}

TEST(Retreat, GoesOnByTheWayThatIsLeftWhereTheModuleFallsSilent) {
  for (const SampleTrouble trouble : {SampleTrouble::kSilent, SampleTrouble::kNotANumber,
                                      SampleTrouble::kSaturated, SampleTrouble::kCableBreak}) {
    RetreatArm arm = retreatingArm();
    arm.trouble = trouble;
    arm.run(2.0);
    EXPECT_EQ(arm.mode(), Mode::kHolding);
    EXPECT_EQ(arm.fault(), Fault::kTactileInvalid) << "the first one stays";
    EXPECT_LE(arm.state().retreat.way, 0.12);
    EXPECT_LE(arm.force_N(), 10.0);
  }
}

TEST(Retreat, EndsInTimeWhateverReadingsSay) {
  Random random(4000);
  for (int i = 0; i < 20; ++i) {
    RetreatArm arm = retreatingArm();
    int cycles = 0;
    while (arm.mode() == Mode::kRetreating && cycles < 3000) {
      if (random.chance(0.05)) arm.trouble = static_cast<SampleTrouble>(random.integer(0, 5));
      arm.step();
      ++cycles;
    }
    EXPECT_EQ(arm.mode(), Mode::kHolding);
    EXPECT_LE(cycles, 1502);
    EXPECT_LE(wayOf(arm, 0.5), 0.02);
  }
}

TEST(Retreat, GoingOnIsGentleAndLeadsBackToThePath) {
  Scene scene = test::shippedScene("scenario1_none");
  scene.controller.tactile_modules.front().max_force_N = 10.0;
  scene.plant.obstacles.front().vanishes_s = 14.0;
  RetreatArm arm(scene, 1);
  ASSERT_TRUE(arm.runUntil(12.0, [&] { return arm.mode() == Mode::kRetreating; }));
  const double left_m = arm.output().error.norm();
  arm.run(3.0);
  ASSERT_EQ(arm.mode(), Mode::kHolding);
  EXPECT_EQ(wayOf(arm, 1.0), 0.0) << "not before the enable line says so";
  EXPECT_LE(left_m, 0.01);
  EXPECT_GE(arm.output().error.norm(), 0.02) << "off its path";
  arm.enable = false;
  arm.run(0.05);
  arm.enable = true;
  arm.step();
  ASSERT_EQ(arm.mode(), Mode::kRunning);
  double fastest = 0.0;
  for (int i = 0; i < 200; ++i) {
    arm.step();
    fastest = std::max(fastest, arm.output().velocity.cwiseAbs().maxCoeff());
  }
  std::printf("going on: %.3f m off the path, %.3f rad/s in the first 0.2 s\n",
              arm.output().error.norm(), fastest);
  EXPECT_LE(fastest, 0.5);
  arm.run(12.0);
  EXPECT_EQ(arm.mode(), Mode::kRunning);
  EXPECT_LE(arm.output().error.norm(), 1e-3);
}

/// null_limit yields to what comes towards it, with a force beyond its own.
TEST(Retreat, FromObstaclesThatComeTowardsTheArm) {
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

TEST(Retreat, IsReplayedToTheBit) {
  Random random(6000);
  for (const SampleTrouble trouble : {SampleTrouble::kNone, SampleTrouble::kSilent,
                                      SampleTrouble::kSaturated, SampleTrouble::kNotANumber}) {
    int met = 0;
    while (met < 3) {
      const Scene scene =
          touchingScene(random, "scenario1_none", {{"simulation.arm", "quasi_static"}});
      RetreatArm arm(scene, 1);
      arm.is_recorded = true;
      const double at_N = trouble == SampleTrouble::kNone ? kNoLimit : 10.0;
      if (!arm.runUntil(4.0, [&] { return arm.mode() != Mode::kRunning || arm.force_N() > at_N; }))
        continue;
      arm.trouble = trouble;
      arm.run(2.0);
      arm.trouble = SampleTrouble::kNone;
      for (const bool enable : {false, true}) {
        arm.enable = enable;
        arm.run(0.1);
      }
      EXPECT_EQ(arm.mode(), Mode::kRunning);
      arm.run(0.5);
      ++met;
      const Controller& controller = arm.controller();
      ControllerState state = controller.initialState();
      ControllerOutput output;
      Mode before = Mode::kRunning;
      int retreating = 0;
      for (const RetreatArm::Cycle& cycle : arm.cycles) {
        applyMode(controller, cycle.mode, before, cycle.input, controller.initialGains(), state);
        controller.update(cycle.input, controller.initialGains(), cycle.task_time_s, scene.period_s,
                          state, output);
        ASSERT_EQ(output.velocity, cycle.output.velocity);
        ASSERT_EQ(output.q_desired, cycle.output.q_desired);
        before = cycle.mode;
        retreating += cycle.mode == Mode::kRetreating ? 1 : 0;
      }
      EXPECT_GT(retreating, 5);
    }
  }
}

}  // namespace
}  // namespace tactus
