#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

#include "support/controller_run.h"
#include "support/retreat_run.h"

/// When an arm retreats, when it does not, who ends it, and how it goes on.
namespace tactus {
namespace {

using test::Random;
using test::RetreatArm;
using test::SampleTrouble;

/// An arm that the shipped scene's path leads on, past a contact or without one.
RetreatArm armAfter(const std::vector<Override>& overrides, double duration_s) {
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
    RetreatArm arm = armAfter({}, 3.0);
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
  RetreatArm arm = armAfter({}, 0.2);  // before its path begins
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

/// Of several modules it is left along the push of the one that is pressed most, by how the point
/// moves in space.
TEST(Retreat, LeavesTheModuleThatIsPressedMost) {
  Random random(8000);
  for (int i = 0; i < 50; ++i) {
    ControllerConfig config = test::fullController(random, random.integer(4, 9), Variant::kNone);
    config.force_control.reset();
    config.has_joint_limit_avoidance = false;
    config.task.trajectory.waypoints.clear();
    config.tactile_modules.push_back(config.tactile_modules.front());
    config.tactile_modules[1].link = test::randomFrame(random, config.chain.size() - 1);
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    const double x_m = random.uniform(0.1, 0.3), angle = random.uniform(0.0, 6.0);
    const int pressed = random.index(2);
    Mode mode = Mode::kRunning, before = Mode::kRunning;
    JointVector q;
    for (int cycle = 0; cycle < 120; ++cycle) {
      RobotInput input{state.q_desired, {}};
      const double force_N = cycle < 20 ? 5.0 * cycle : 120.0;
      const auto sequence = static_cast<std::uint32_t>(cycle + 1);
      input.tactile[pressed] = test::touchAt(x_m, force_N, angle, sequence);
      input.tactile[1 - pressed] = test::touchAt(0.2, 3.0, 0.0, sequence);
      applyMode(controller, mode, before, input, config.gains, state);
      controller.update(input, config.gains, 0.0, 1e-3, state, output);
      before = mode;
      if (cycle == 20) {
        ASSERT_EQ(output.fault, Fault::kTactileInvalid);
        mode = Mode::kRetreating;
        q = state.q_desired;
      }
    }
    const auto poseOf = [&](const JointVector& at) {
      ChainPose pose;
      config.chain.computePose(at, pose);
      return framePose(pose, config.tactile_modules[pressed].link);
    };
    const Pose was = poseOf(q), is = poseOf(state.q_desired);
    const Vector3 push = was.R_AB * Vector3(0.0, std::cos(angle), std::sin(angle));
    const Vector3 p_Module(x_m, 0.0, 0.0);
    const double way_m =
        push.dot((is.p_AB + is.R_AB * p_Module) - (was.p_AB + was.R_AB * p_Module));
    EXPECT_EQ(state.retreat.module, pressed);
    EXPECT_NEAR(way_m, state.retreat.way, 1e-4) << i;
    EXPECT_NEAR(way_m, 0.5 * 2.0 * 0.099 * 0.099, 0.003) << i;
  }
}

/// As in a log that nobody wrote: modes in any order, readings of any kind.
TEST(Retreat, NoOrderOfModesTakesTheArmBeyondItsLimits) {
  Random random(7000);
  for (const auto& [variant, level] : test::allLaws()) {
    const ControllerConfig config =
        test::fullController(random, random.integer(3, 9), variant, level);
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    test::RandomTouches touches(random);
    Mode mode = Mode::kRetreating, before = Mode::kBoot;
    for (int cycle = 0; cycle < 3000; ++cycle) {
      RobotInput input = touches.next(state.q_desired);
      const double kinds[] = {0.0, 90.0, 150.0, 1e200, std::numeric_limits<double>::quiet_NaN()};
      if (random.chance(0.3)) input.tactile[0].force_y_N += kinds[random.index(5)];
      applyMode(controller, mode, before, input, config.gains, state);
      const JointVector velocity_before = state.velocity_before;
      controller.update(input, config.gains, 1e-3 * cycle, 1e-3, state, output);
      ASSERT_EQ(output.velocity.size(), config.chain.size());
      const JointVector change = (output.velocity - velocity_before).cwiseAbs();
      ASSERT_LE((change - 1e-3 * config.limits.max_acceleration).maxCoeff(), 1e-9) << cycle;
      ASSERT_LE((output.velocity.cwiseAbs() - config.limits.max_velocity).maxCoeff(), 1e-9);
      ASSERT_LE((state.q_desired - config.limits.upper).maxCoeff(), 0.0);
      ASSERT_GE((state.q_desired - config.limits.lower).minCoeff(), 0.0);
      before = mode;
      if (random.chance(0.02)) mode = static_cast<Mode>(random.index(kModeCount));
    }
  }
}

TEST(Retreat, IsReplayedToTheBit) {
  Random random(6000);
  for (const SampleTrouble trouble : {SampleTrouble::kNone, SampleTrouble::kSilent,
                                      SampleTrouble::kSaturated, SampleTrouble::kNotANumber}) {
    int met = 0;
    while (met < 3) {
      const Scene scene =
          test::touchingScene(random, "scenario1_none", {{"simulation.arm", "quasi_static"}});
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
