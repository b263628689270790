#include "tactus/supervisor/mode.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/random.h"

namespace tactus {
namespace {

/// A robot that does in the end what the mode asks of it.
struct ObedientRobot {
  ModeConfig config;
  ModeState state;
  ModeInput input;

  void step() {
    const bool has_power = state.mode == Mode::kEnabling || state.mode == Mode::kRunning ||
                           state.mode == Mode::kRetreating || state.mode == Mode::kHolding;
    input.are_configured = state.mode == Mode::kBoot;
    input.is_at_rest = state.mode != Mode::kRunning && state.mode != Mode::kRetreating;
    input.is_retreat_over = state.cycles_in_mode > 3;
    input.are_enabled = has_power;
    input.are_disabled = !has_power;
    updateMode(config, input, state);
  }
  Mode run(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
    return state.mode;
  }
  Mode runWith(Fault fault) {
    input.fault = fault;
    step();
    input.fault = Fault::kNone;
    return state.mode;
  }
};

ObedientRobot running(bool has_enable_line) {
  ObedientRobot robot;
  robot.input.has_enable_line = has_enable_line;
  robot.run(10);
  return robot;
}

TEST(FaultTable, HasOneRowAFaultInTheOrderOfTheNumbers) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < faultTable().size(); ++i) {
    const FaultRow& row = faultTable()[i];
    EXPECT_EQ(static_cast<std::size_t>(row.fault), i);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(row.reaction == Reaction::kNone, row.fault == Fault::kNone);
    EXPECT_EQ(std::string(row.detection).empty(), row.fault == Fault::kNone);
    EXPECT_EQ(std::string(row.within).empty(), row.fault == Fault::kNone);
    EXPECT_EQ(std::string(row.remains).empty(), row.fault == Fault::kNone);
  }
  EXPECT_EQ(faultRow(static_cast<Fault>(200)).fault, Fault::kNone);
  EXPECT_STREQ(faultName(static_cast<Fault>(200)), "unknown");
}

TEST(Mode, ReachesRunningThroughBootReadyAndEnabling) {
  ObedientRobot robot;
  std::vector<Mode> modes;
  for (int i = 0; i < 4; ++i) modes.push_back(robot.run(1));
  EXPECT_EQ(modes, (std::vector{Mode::kReady, Mode::kEnabling, Mode::kRunning, Mode::kRunning}));
}

TEST(Mode, WaitsForTheEnableLine) {
  ObedientRobot robot;
  robot.input.has_enable_line = true;
  robot.input.enable = false;
  EXPECT_EQ(robot.run(100), Mode::kReady);
  robot.input.enable = true;
  EXPECT_EQ(robot.run(2), Mode::kRunning);
  robot.input.enable = false;
  EXPECT_EQ(robot.run(1), Mode::kHolding);
  EXPECT_EQ(robot.run(100), Mode::kHolding);
  robot.input.enable = true;
  EXPECT_EQ(robot.run(1), Mode::kRunning);
}

TEST(Mode, AnswersEveryFaultByItsRow) {
  for (const FaultRow& row : faultTable()) {
    if (row.fault == Fault::kNone) continue;
    ObedientRobot robot = running(true);
    ASSERT_EQ(robot.state.mode, Mode::kRunning);
    const Mode mode = robot.runWith(row.fault);
    const Mode expected = row.reaction == Reaction::kRetreat ? Mode::kRetreating
                          : row.reaction == Reaction::kRamp  ? Mode::kStopping
                                                             : Mode::kFault;
    EXPECT_EQ(mode, expected) << row.name;
    EXPECT_EQ(robot.state.fault, row.fault);
  }
}

TEST(Mode, ClearsFaultsOnlyByEnableOffAndOn) {
  for (const FaultRow& row : faultTable()) {
    if (row.fault == Fault::kNone) continue;
    ObedientRobot robot = running(true);
    robot.runWith(row.fault);
    const Mode rest = row.reaction == Reaction::kRetreat ? Mode::kHolding : Mode::kFault;
    EXPECT_EQ(robot.run(5000), rest) << row.name;
    robot.input.enable = false;
    EXPECT_EQ(robot.run(10), rest) << row.name;
    robot.runWith(row.fault);  // the cause is still there, so the line has to go off anew
    robot.input.enable = true;
    EXPECT_EQ(robot.run(10), rest) << row.name;
    robot.input.enable = false;
    robot.run(1);
    robot.input.enable = true;
    EXPECT_EQ(robot.run(10), Mode::kRunning) << row.name;
    EXPECT_EQ(robot.state.fault, Fault::kNone);
    EXPECT_FALSE(robot.state.may_clear) << "that was for this fault alone";
  }
}

TEST(Mode, EndsAfterAFaultWithoutEnableLine) {
  for (const FaultRow& row : faultTable()) {
    if (row.fault == Fault::kNone) continue;
    ObedientRobot robot = running(false);
    robot.runWith(row.fault);
    EXPECT_EQ(robot.run(10), Mode::kOff) << row.name;
    EXPECT_EQ(robot.state.fault, row.fault) << "the reason is kept";
  }
}

TEST(Mode, AHarsherFaultOverridesAMilderOneButNeverTheOtherWayRound) {
  for (const FaultRow& first : faultTable()) {
    for (const FaultRow& second : faultTable()) {
      if (first.fault == Fault::kNone) continue;
      ObedientRobot robot = running(true);
      robot.runWith(first.fault);
      robot.runWith(second.fault);
      EXPECT_GE(robot.state.reaction, first.reaction);
      EXPECT_GE(robot.state.reaction, second.reaction);
      EXPECT_EQ(robot.state.fault, first.fault);
      if (second.reaction >= Reaction::kQuickStop) {
        EXPECT_EQ(robot.state.mode, Mode::kFault);
      }
    }
  }
}

TEST(Mode, TimeLimitsEndWhatNeverHappens) {
  ModeState state;
  ModeInput input;
  for (int i = 0; i < 5000; ++i) updateMode({}, input, state);
  EXPECT_EQ(state.mode, Mode::kBoot);
  updateMode({}, input, state);
  EXPECT_EQ(state.mode, Mode::kFault);
  EXPECT_EQ(state.fault, Fault::kDriveSetupRefused);

  state = {};
  input.are_configured = true;
  for (int i = 0; i < 2003; ++i) updateMode({}, input, state);
  EXPECT_EQ(state.mode, Mode::kFault);
  EXPECT_EQ(state.fault, Fault::kDriveStateLost);

  state = {};
  state.mode = Mode::kStopping;
  input.are_disabled = false;
  input.stop_requested = true;
  for (int i = 0; i < 2001; ++i) updateMode({}, input, state);
  EXPECT_EQ(state.mode, Mode::kFault);
  for (int i = 0; i < 2001; ++i) updateMode({}, input, state);
  EXPECT_EQ(state.mode, Mode::kOff) << "the end comes even if drives never answer";
}

TEST(Mode, ARetreatEndsInAHoldWhoeverEndsIt) {
  for (const bool has_time_limit : {false, true}) {
    ModeState state;
    state.mode = Mode::kRunning;
    ModeInput input;
    input.has_enable_line = true;
    input.are_enabled = true;
    input.is_at_rest = false;
    input.fault = Fault::kTactileStale;
    updateMode({}, input, state);
    for (int i = 0; i < 1500; ++i) {
      ASSERT_EQ(state.mode, Mode::kRetreating) << i;
      input.is_retreat_over = !has_time_limit && i == 700;
      updateMode({}, input, state);
      if (input.is_retreat_over) break;
    }
    if (has_time_limit) updateMode({}, input, state);
    EXPECT_EQ(state.mode, Mode::kHolding) << has_time_limit;
  }
}

TEST(Mode, MissedCyclesAreOfARetreatsTime) {
  ModeState state;
  state.mode = Mode::kRetreating;
  ModeInput input;
  input.missed_cycles = 1500;
  updateMode({}, input, state);
  EXPECT_EQ(state.mode, Mode::kHolding);
}

/// Stops have deadlines of time, also where the loop was late; all else waits for what is heard.
TEST(Mode, MissedCyclesCountInStopsAlone) {
  for (const Mode mode : {Mode::kBoot, Mode::kReady, Mode::kEnabling, Mode::kRunning,
                          Mode::kHolding, Mode::kStopping, Mode::kFault, Mode::kRetreating}) {
    ModeState state;
    state.mode = mode;
    ModeInput input;
    input.has_enable_line = true;
    input.enable = mode == Mode::kRunning || mode == Mode::kEnabling || mode == Mode::kRetreating;
    input.is_at_rest = input.are_disabled = false;
    input.missed_cycles = 7;
    updateMode({}, input, state);
    ASSERT_EQ(state.mode, mode);
    const bool is_stop =
        mode == Mode::kStopping || mode == Mode::kFault || mode == Mode::kRetreating;
    EXPECT_EQ(state.cycles_in_mode, is_stop ? 8 : 1) << modeName(mode);
  }
}

/// Every drive has to follow for as long as brakes take to open, without a break.
TEST(Mode, WaitsForTheBrakesWhileAllDrivesFollow) {
  ModeConfig config;
  config.brake_cycles = 3;
  const auto cyclesToRun = [&](ModeState state, std::vector<bool> follows) {
    ModeInput input;
    input.are_configured = true;
    for (int cycles = 1; cycles < 20; ++cycles) {
      if (state.mode == Mode::kEnabling && !follows.empty()) {
        input.are_enabled = follows.front();
        follows.erase(follows.begin());
      } else {
        input.are_enabled = true;
      }
      updateMode(config, input, state);
      if (state.mode == Mode::kRunning) return cycles;
    }
    return 20;
  };
  ModeState enabling;
  enabling.mode = Mode::kEnabling;
  EXPECT_EQ(cyclesToRun(enabling, {}), 4);
  EXPECT_EQ(cyclesToRun(enabling, {true, true, true, false}), 8) << "a break begins it anew";
  EXPECT_EQ(cyclesToRun({}, {}), 2 + 4) << "through boot and ready";
}

/// The brakes have closed meanwhile.
TEST(Mode, GivesBrakesAllOfTheirTimeAfterAnEnablingThatWasGivenUp) {
  ModeConfig config;
  config.brake_cycles = 3;
  ModeInput input;
  input.has_enable_line = input.are_configured = input.are_enabled = true;
  ModeState state;
  state.mode = Mode::kEnabling;
  for (int i = 0; i < 3; ++i) updateMode(config, input, state);
  input.enable = false;
  while (state.mode != Mode::kReady) {
    updateMode(config, input, state);
    ASSERT_TRUE(state.mode == Mode::kStopping || state.mode == Mode::kReady);
  }
  input.enable = true;
  updateMode(config, input, state);
  for (int i = 0; i < 3; ++i) {
    updateMode(config, input, state);
    ASSERT_EQ(state.mode, Mode::kEnabling) << i;
  }
  updateMode(config, input, state);
  EXPECT_EQ(state.mode, Mode::kRunning);
}

ModeInput randomInput(test::Random& random) {
  ModeInput input;
  if (random.chance(0.05)) input.fault = static_cast<Fault>(random.integer(0, 21));
  input.has_enable_line = true;
  input.enable = random.chance(0.7);
  input.are_configured = random.chance(0.5);
  input.are_enabled = random.chance(0.5);
  input.are_disabled = random.chance(0.5);
  input.is_at_rest = random.chance(0.5);
  input.is_retreat_over = random.chance(0.3);
  return input;
}

TEST(Mode, ChangesOnlyAlongTheTableAndUsesAllOfIt) {
  test::Random random(1);
  ModeConfig config;
  config.boot_cycles = config.enabling_cycles = config.stopping_cycles = 4;
  config.retreating_cycles = 4;
  std::set<std::pair<Mode, Mode>> seen;
  for (int run = 0; run < 2000; ++run) {
    ModeState state;
    const int stop_at = random.index(150);
    const bool has_enable_line = random.chance(0.7);
    for (int i = 0; i < 200; ++i) {
      const ModeState before = state;
      ModeInput input = randomInput(random);
      input.has_enable_line = has_enable_line;
      input.stop_requested = i >= stop_at;
      updateMode(config, input, state);
      if (state.mode == before.mode) continue;
      EXPECT_TRUE(isLegal(before.mode, state.mode))
          << modeName(before.mode) << " to " << modeName(state.mode);
      EXPECT_EQ(state.cycles_in_mode, 0);
      if (state.mode == Mode::kRunning) {
        EXPECT_EQ(state.fault, Fault::kNone);
        EXPECT_FALSE(input.stop_requested);
      }
      seen.insert({before.mode, state.mode});
    }
    EXPECT_EQ(state.mode, Mode::kOff) << "a stop always comes to an end";
  }
  for (int from = 0; from < kModeCount; ++from)
    for (int to = 0; to < kModeCount; ++to) {
      const std::pair change(static_cast<Mode>(from), static_cast<Mode>(to));
      EXPECT_EQ(isLegal(change.first, change.second), seen.count(change) == 1)
          << modeName(change.first) << " to " << modeName(change.second);
    }
}

/// Who does what it says comes on, from wherever chance has led to.
TEST(Mode, SaysWhatItWaitsFor) {
  test::Random random(2);
  ModeConfig config;
  config.boot_cycles = config.enabling_cycles = config.stopping_cycles = 4;
  config.retreating_cycles = 4;
  std::set<WaitsFor> said;
  for (int run = 0; run < 2000; ++run) {
    ModeState state;
    ModeInput input;
    for (int i = random.index(150); i > 0; --i) {
      input = randomInput(random);
      updateMode(config, input, state);
      const WayOn way_on = wayOn(config, input, state);
      said.insert(way_on.waits_for);
      if (way_on.waits_for == WaitsFor::kNothing) continue;
      EXPECT_EQ(way_on.fault, input.fault);
      EXPECT_EQ(way_on.waits_for == WaitsFor::kFaultGone, input.fault != Fault::kNone);
      EXPECT_NE(state.mode, Mode::kRunning);
    }
    input.fault = Fault::kNone;
    input.must_go_off = !input.enable && random.chance(0.5);
    input.are_configured = input.are_enabled = input.is_at_rest = true;
    for (int i = 0; i < 50 && state.mode != Mode::kRunning; ++i) {
      updateMode(config, input, state);
      const WaitsFor waits_for = wayOn(config, input, state).waits_for;
      if (waits_for == WaitsFor::kEnableOff) input.enable = input.must_go_off = false;
      if (waits_for == WaitsFor::kEnableOn) input.enable = true;
    }
    ASSERT_EQ(state.mode, Mode::kRunning) << "run " << run;
    EXPECT_EQ(wayOn(config, input, state).waits_for, WaitsFor::kNothing);
  }
  EXPECT_EQ(said.size(), 5u);
}

/// Where nobody can switch anything on, or the arm goes on or ends by itself.
TEST(Mode, SaysNothingWhereNothingIsWaitedFor) {
  const ModeConfig config;
  for (int i = 0; i < kModeCount; ++i)
    for (const Fault fault : {Fault::kNone, Fault::kEmergencyStop}) {
      ModeState state;
      state.mode = static_cast<Mode>(i);
      state.fault = fault;
      const bool is_stopped = state.mode == Mode::kReady || state.mode == Mode::kHolding ||
                              state.mode == Mode::kFault ||
                              (state.mode == Mode::kStopping && fault != Fault::kNone);
      ModeInput input;
      input.has_enable_line = true;
      input.enable = false;
      EXPECT_EQ(wayOn(config, input, state).waits_for != WaitsFor::kNothing, is_stopped)
          << modeName(state.mode) << " with fault " << static_cast<int>(fault);
      input.stop_requested = true;
      EXPECT_EQ(wayOn(config, input, state).waits_for, WaitsFor::kNothing);
      input.stop_requested = input.has_enable_line = false;
      EXPECT_EQ(wayOn(config, input, state).waits_for, WaitsFor::kNothing);
    }
}

}  // namespace
}  // namespace tactus
