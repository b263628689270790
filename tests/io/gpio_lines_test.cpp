#include "tactus/io/gpio_lines.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>

#include "io/fake_gpiod.h"
#include "support/allocation_guard.h"
#include "support/period.h"
#include "tactus/io/gpio_survey.h"

namespace tactus {
namespace {

using test::drive;
using test::fake_chip;
using test::resetFakeChip;

using test::kPeriod_s;

GpioConfig allLines(bool is_active_low = false, double debounce_s = 0.0) {
  GpioConfig config;
  config.chip = "gpiochip0";
  config.e_stop = {1, is_active_low, debounce_s};
  config.enable = {2, is_active_low, debounce_s};
  config.brake = {3, is_active_low, 0.0};
  config.heartbeat = {4, is_active_low, 0.0};
  return config;
}

std::string errorOf(const GpioConfig& config) {
  try {
    const GpioLines lines(config, kPeriod_s);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(GpioLines, SaysWhichChipOrLineIsMissingOrTaken) {
  GpioConfig config = allLines();
  resetFakeChip().is_present = false;
  EXPECT_NE(errorOf(config).find("gpiochip0: cannot open"), std::string::npos);
  resetFakeChip();
  config.brake->line = 8;
  EXPECT_EQ(errorOf(config), "gpiochip0: has no line 8, expected 0 to 7");
  config.brake->line = -1;
  EXPECT_NE(errorOf(config).find("has no line -1"), std::string::npos);
  for (const unsigned taken : {1U, 2U, 3U, 4U}) {
    resetFakeChip().lines[taken].is_taken = true;
    const std::string error = errorOf(allLines());
    EXPECT_NE(error.find("cannot request line " + std::string(taken >= 3 ? "3, 4" : "")),
              std::string::npos)
        << error;
    EXPECT_NE(error.find("gpioinfo"), std::string::npos) << error;
    EXPECT_FALSE(fake_chip.is_open) << "left open";
  }
}

TEST(GpioLines, ARobotWithoutLinesReadsAsSafeToMoveAndCostsNothing) {
  resetFakeChip();
  GpioConfig none;
  none.chip = "gpiochip0";
  GpioLines lines(none, kPeriod_s);
  const GpioInputs inputs = lines.read();
  EXPECT_FALSE(inputs.emergency_stop);
  EXPECT_TRUE(inputs.enable);
  EXPECT_TRUE(inputs.is_valid);
  EXPECT_TRUE(lines.write({true, true}));
  EXPECT_EQ(fake_chip.calls, 0);
}

TEST(GpioLines, ReadsAndWritesByThePolarityOfEachLine) {
  for (const bool has_events : {true, false}) {
    for (int low = 0; low < 16; ++low) {
      resetFakeChip().has_events = has_events;
      GpioConfig config = allLines();
      config.e_stop->active_low = (low & 1) != 0;
      config.enable->active_low = (low & 2) != 0;
      config.brake->active_low = (low & 4) != 0;
      config.heartbeat->active_low = (low & 8) != 0;
      drive(1, low & 1);  // both inactive at first
      drive(2, (low & 2) != 0);
      GpioLines lines(config, kPeriod_s);
      EXPECT_EQ(lines.seesPulses(), has_events);
      for (int active = 0; active < 16; ++active) {
        drive(1, (active & 1) != (low & 1));
        drive(2, (active & 2) != (low & 2));
        if (has_events) lines.read();  // an edge of the cycle before counts once more
        const GpioInputs inputs = lines.read();
        EXPECT_EQ(inputs.emergency_stop, (active & 1) != 0) << low << " " << active;
        EXPECT_EQ(inputs.enable, (active & 2) != 0) << low << " " << active;
        EXPECT_TRUE(inputs.is_valid);
        EXPECT_TRUE(lines.write({(active & 4) != 0, (active & 8) != 0}));
        EXPECT_EQ(fake_chip.lines[3].level != 0, (active & 4) != (low & 4));
        EXPECT_EQ(fake_chip.lines[4].level != 0, (active & 8) != (low & 8));
      }
    }
  }
}

TEST(GpioLines, OutputsAreInactiveFromTheRequestAndWhenTheObjectGoes) {
  for (const bool is_active_low : {false, true}) {
    resetFakeChip();
    {
      GpioLines lines(allLines(is_active_low), kPeriod_s);
      EXPECT_EQ(fake_chip.lines[3].level, is_active_low);
      EXPECT_EQ(fake_chip.lines[4].level, is_active_low);
      lines.write({true, true});
      EXPECT_EQ(fake_chip.lines[3].level, !is_active_low);
    }
    EXPECT_EQ(fake_chip.lines[3].level, is_active_low);
    EXPECT_EQ(fake_chip.lines[4].level, is_active_low);
    EXPECT_FALSE(fake_chip.is_open);
  }
}

TEST(GpioLines, SeesAPulseOfTheEmergencyStopBetweenTwoCycles) {
  for (const bool is_active_low : {false, true}) {
    resetFakeChip();
    drive(1, is_active_low);
    GpioLines lines(allLines(is_active_low, 0.003), kPeriod_s);
    ASSERT_TRUE(lines.seesPulses());
    EXPECT_FALSE(lines.read().emergency_stop);
    drive(1, !is_active_low);
    drive(1, is_active_low);
    EXPECT_TRUE(lines.read().emergency_stop);
    EXPECT_TRUE(lines.read().emergency_stop);
    EXPECT_TRUE(lines.read().emergency_stop);
    EXPECT_FALSE(lines.read().emergency_stop) << "released for three cycles";
  }
}

TEST(GpioLines, WithoutEventsThePulseIsMissedAndALevelIsNot) {
  resetFakeChip().has_events = false;
  GpioLines lines(allLines(), kPeriod_s);
  drive(1, 1);
  drive(1, 0);
  EXPECT_FALSE(lines.read().emergency_stop);
  drive(1, 1);
  EXPECT_TRUE(lines.read().emergency_stop);
}

/// Where the chip has resistors of its own.
TEST(GpioLines, AWireThatComesOffStopsTheArm) {
  for (const bool has_events : {true, false}) {
    for (int low = 0; low < 4; ++low) {
      resetFakeChip().has_events = has_events;
      GpioConfig config = allLines();
      config.e_stop->active_low = (low & 1) != 0;
      config.enable->active_low = (low & 2) != 0;
      drive(1, config.e_stop->active_low);
      drive(2, !config.enable->active_low);
      GpioLines lines(config, kPeriod_s);
      EXPECT_FALSE(lines.read().emergency_stop);
      EXPECT_TRUE(lines.read().enable);
      test::unplug(1);
      EXPECT_TRUE(lines.read().emergency_stop) << low;
      test::unplug(2);
      EXPECT_FALSE(lines.read().enable) << low;
      EXPECT_EQ(fake_chip.lines[3].pull, 0) << "an output";
    }
  }
}

TEST(GpioLines, AChipThatRefusesToPullIsTakenAsItIs) {
  for (const bool has_events : {true, false}) {
    resetFakeChip().has_events = has_events;
    fake_chip.refuses_pulls = true;
    drive(2, 1);
    GpioLines lines(allLines(), kPeriod_s);
    EXPECT_EQ(lines.seesPulses(), has_events);
    EXPECT_TRUE(lines.read().enable);
    EXPECT_EQ(fake_chip.lines[1].pull, 0);
    drive(1, 1);
    EXPECT_TRUE(lines.read().emergency_stop);
  }
}

TEST(GpioLines, ReleaseAloneIsNoPress) {
  for (const bool is_active_low : {false, true}) {
    resetFakeChip();
    drive(1, !is_active_low);
    GpioLines lines(allLines(is_active_low), kPeriod_s);
    EXPECT_TRUE(lines.read().emergency_stop) << "pressed at the start";
    drive(1, is_active_low);
    EXPECT_FALSE(lines.read().emergency_stop);
  }
}

TEST(GpioLines, AnEnableThatBouncesIsNoEnable) {
  resetFakeChip();
  GpioLines lines(allLines(false, 0.003), kPeriod_s);
  for (int i = 0; i < 20; ++i) {
    drive(2, i % 3 != 0);
    EXPECT_FALSE(lines.read().enable);
  }
  drive(2, 1);
  for (int i = 0; i < 3; ++i) lines.read();
  EXPECT_TRUE(lines.read().enable);
}

TEST(GpioLines, AChipThatGoesIsToldAndTheLastLevelsStay) {
  resetFakeChip();
  drive(2, 1);
  GpioLines lines(allLines(), kPeriod_s);
  lines.read();
  fake_chip.is_gone = true;
  const GpioInputs inputs = lines.read();
  EXPECT_FALSE(inputs.is_valid);
  EXPECT_FALSE(inputs.emergency_stop);
  EXPECT_TRUE(inputs.enable);
  EXPECT_FALSE(lines.write({true, true}));
  fake_chip.is_gone = false;
  EXPECT_TRUE(lines.read().is_valid);
}

TEST(GpioLines, TakesAsManySystemCallsAsItSaysAndNoHeap) {
  for (const bool has_events : {true, false}) {
    resetFakeChip().has_events = has_events;
    GpioLines lines(allLines(), kPeriod_s);
    fake_chip.calls = 0;
    {
      const test::AllocationGuard guard;
      lines.read();
    }
    EXPECT_EQ(fake_chip.calls, has_events ? 3 : 2);
    fake_chip.calls = 0;
    {
      const test::AllocationGuard guard;
      lines.write({true, false});
    }
    EXPECT_EQ(fake_chip.calls, 1);
  }
}

/// A contact that chatters faster than the loop: bounded work, and the press is not lost.
TEST(GpioLines, DrainsABoundedNumberOfEventsACycle) {
  resetFakeChip();
  GpioLines lines(allLines(), kPeriod_s);
  for (int i = 0; i < 100; ++i) drive(1, i % 2 == 0);
  EXPECT_TRUE(lines.read().emergency_stop);
  EXPECT_GE(fake_chip.events.size(), 84u);
  for (int i = 0; i < 7; ++i) lines.read();
  EXPECT_TRUE(fake_chip.events.empty());
  EXPECT_FALSE(lines.read().emergency_stop);
}

TEST(GpioSurvey, NamesWhatIsMissingAndWhoHoldsLinesAndTakesNone) {
  GpioConfig config = allLines();
  resetFakeChip().is_present = false;
  EXPECT_NE(surveyGpio(config).problem.find("gpiochip0: cannot open"), std::string::npos);
  resetFakeChip();
  EXPECT_EQ(surveyGpio(config).problem, "");
  EXPECT_EQ(surveyGpio(config).users, "");
  EXPECT_FALSE(fake_chip.is_open);
  for (const test::FakeLine& line : fake_chip.lines)
    EXPECT_EQ(line.requested, test::Requested::kNo);
  for (const bool has_others : {false, true}) {
    GpioConfig of_others;
    of_others.chip = config.chip;
    of_others.enable = config.enable;
    const GpioLines others(of_others, kPeriod_s);
    fake_chip.lines[4].is_taken = has_others;
    const GpioSurvey survey = surveyGpio(config);
    EXPECT_EQ(survey.users, has_others ? "line 2: tactusd, line 4: the kernel" : "line 2: tactusd");
  }
  config.brake->line = 8;
  EXPECT_EQ(surveyGpio(config).problem, "gpiochip0: has no line 8, expected 0 to 7");
}

}  // namespace
}  // namespace tactus
