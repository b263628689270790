#include "tactus/supervisor/apply_mode.h"

#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/random_limits.h"
#include "support/random_robot.h"

/// What a mode makes of the controller's state.
namespace tactus {
namespace {

/// Whenever drives move the arm by themselves it is where they say, in the first cycle of the
/// command, too; in between it is where it was commanded to be.
TEST(ApplyMode, TheArmIsWhereWhoeverMovesItSays) {
  test::Random random(2601);
  const Controller controller(test::randomController(random, 5, 2));
  const JointVector measured = random.vector(5, -0.5, 0.5), commanded = random.vector(5, -0.5, 0.5);
  for (int to = 0; to < kModeCount; ++to) {
    for (int from = 0; from < kModeCount; ++from) {
      const Mode mode = static_cast<Mode>(to), before = static_cast<Mode>(from);
      ControllerState state = controller.initialState(commanded);
      state.velocity_before.setConstant(0.1);
      applyMode(controller, mode, before, {measured, {}}, controller.initialGains(), state);
      const bool goes_on = isCommanding(mode) && isCommanding(before);
      EXPECT_EQ(state.q_desired, goes_on ? commanded : measured) << from << " " << to;
      EXPECT_EQ(state.velocity_before.isZero(0.0), !goes_on) << from << " " << to;
      EXPECT_EQ(state.mayMove(), mode == Mode::kRunning) << from << " " << to;
      EXPECT_EQ(state.retreat.is_under_way, mode == Mode::kRetreating) << from << " " << to;
    }
  }
}

/// While it retreats or holds, and in the cycle after, the mode alone remembers faults; one that
/// runs keeps its own.
TEST(ApplyMode, AFaultIsForgottenWhileTheArmIsHeld) {
  test::Random random(2602);
  const Controller controller(test::randomController(random, 5, 2));
  const auto isForgotten = [&](Mode mode, Mode before) {
    ControllerState state = controller.initialState();
    state.fault = Fault::kTactileStale;
    applyMode(controller, mode, before, {state.q_desired, {}}, controller.initialGains(), state);
    return state.fault == Fault::kNone;
  };
  EXPECT_FALSE(isForgotten(Mode::kRunning, Mode::kRunning));
  EXPECT_FALSE(isForgotten(Mode::kStopping, Mode::kRunning));
  for (const Mode still : {Mode::kRetreating, Mode::kHolding}) {
    EXPECT_TRUE(isForgotten(still, Mode::kRunning));
    EXPECT_TRUE(isForgotten(still, still));
    EXPECT_TRUE(isForgotten(Mode::kRunning, still));
    EXPECT_TRUE(isForgotten(Mode::kStopping, still));
  }
}

/// A way out begins once, and is left once: then the arm makes for its path gently.
TEST(ApplyMode, BeginsAWayOutOnceAndGoesOnOnce) {
  test::Random random(2603);
  const Controller controller(test::randomController(random, 5, 2));
  const auto after = [&](Mode mode, Mode before) {
    ControllerState state = controller.initialState();
    state.retreat.time_s = 1.0;
    state.retreat.has_moved = true;
    applyMode(controller, mode, before, {state.q_desired, {}}, controller.initialGains(), state);
    return state;
  };
  EXPECT_EQ(after(Mode::kRetreating, Mode::kRunning).retreat.time_s, 0.0);
  EXPECT_EQ(after(Mode::kRetreating, Mode::kRetreating).retreat.time_s, 1.0);
  EXPECT_EQ(after(Mode::kHolding, Mode::kRetreating).retreat.time_s, 1.0);
  EXPECT_EQ(after(Mode::kRunning, Mode::kHolding).return_share, 0.0);
  EXPECT_EQ(after(Mode::kRunning, Mode::kRunning).return_share, 1.0);
  EXPECT_EQ(after(Mode::kHolding, Mode::kRetreating).return_share, 1.0);
  EXPECT_EQ(after(Mode::kFault, Mode::kRunning).return_share, 0.0);
  EXPECT_EQ(after(Mode::kFault, Mode::kFault).return_share, 1.0);
}

/// Drives that are set up may say anything of where joints are: what covers feel of it is no
/// motion. In every other mode what they have felt goes on.
/// One that starts where its scene begins is at once on its path, as simulated.
TEST(ApplyMode, OnlyAnArmThatWasHeldGoesOnGently) {
  test::Random random(2604);
  const ControllerConfig config = test::fullController(random, 6, Variant::kJointSpace);
  const Controller controller(config);
  const auto shareAfter = [&](Mode before) {
    ControllerState state = controller.initialState();
    applyMode(controller, Mode::kRunning, before, {state.q_desired, {}}, config.gains, state);
    return state.return_share;
  };
  for (const Mode before : {Mode::kBoot, Mode::kReady, Mode::kEnabling, Mode::kRunning})
    EXPECT_EQ(shareAfter(before), 1.0);
  EXPECT_EQ(shareAfter(Mode::kHolding), 0.0);
}

/// Only as it begins to be held: a hand that touches it later is nothing that it leant on.
TEST(ApplyMode, RemembersWhetherAnArmLeantWhenItWasHeld) {
  test::Random random(2605);
  const ControllerConfig config = test::fullController(random, 6, Variant::kNullSpace);
  const Controller controller(config);
  const auto hasLeaned = [&](Mode mode, Mode before) {
    ControllerState state = controller.initialState();
    state.modules[0].contact.force_N = 5.0;
    applyMode(controller, mode, before, {state.q_desired, {}}, config.gains, state);
    return state.has_leaned;
  };
  EXPECT_TRUE(hasLeaned(Mode::kHolding, Mode::kRunning));
  EXPECT_TRUE(hasLeaned(Mode::kRetreating, Mode::kRunning));
  EXPECT_FALSE(hasLeaned(Mode::kHolding, Mode::kHolding));
  EXPECT_FALSE(hasLeaned(Mode::kHolding, Mode::kRetreating));
  EXPECT_FALSE(hasLeaned(Mode::kRunning, Mode::kRunning));
}

TEST(ApplyMode, ForgetsTheMotionOfCoversInABootAndInItsFirstCycleAfter) {
  for (int to = 0; to < kModeCount; ++to) {
    for (int from = 0; from < kModeCount; ++from) {
      const Mode mode = static_cast<Mode>(to), before = static_cast<Mode>(from);
      ControllerState state;
      for (TactileReading& reading : state.modules) reading.cover.has_started = true;
      forgetMotionWhileBooting(mode, before, state);
      const bool is_booting = mode == Mode::kBoot || before == Mode::kBoot;
      for (const TactileReading& reading : state.modules)
        EXPECT_EQ(reading.cover.has_started, !is_booting) << from << " " << to;
    }
  }
}

}  // namespace
}  // namespace tactus
