#include <gtest/gtest.h>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// The tactile module falls silent for long while the arm moves, and comes back.
namespace tactus {
namespace {

using test::VirtualRobotCell;

TEST(ControlCycleTactileSilence, EndsWithTheFirstSampleWhateverItsNumber) {
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  VirtualRobotCell silent(scene);
  ASSERT_TRUE(silent.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) silent.step();
  silent.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3) frame.id = 0x7FF;
  };
  for (int i = 0; i < 10'000; ++i) silent.step();
  ASSERT_EQ(silent.cycle.report().fault, Fault::kTactileStale);
  ASSERT_EQ(silent.cycle.report().mode, Mode::kHolding);
  for (int phase = 0; phase < 16; ++phase) {
    SCOPED_TRACE(phase);
    VirtualRobotCell cell = silent;
    cell.on_frame = nullptr;
    for (int i = 0; i < 10; ++i) cell.step();
    EXPECT_EQ(cell.cycle.report().mode, Mode::kHolding) << "not before the enable line says so";
    cell.switchEnable();
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5)) << faultName(cell.cycle.report().fault);
    for (int i = 0; i < 16 * 4; ++i) silent.step();  // 16 samples on: a sixteenth of the numbers
  }
}

/// The first cycle of motion gives the controller a new state, but the sample no new age.
TEST(ControlCycleTactileSilence, IsSeenInTimeAlsoWhereItBeganBeforeTheMotion) {
  constexpr int kLongest = 20;  // ms, before the motion
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace().brake.emplace();  // which take their time to open
  VirtualRobotCell booted(scene);
  ASSERT_TRUE(booted.runUntil(Mode::kEnabling, 5000));
  int cycles_to_run = 0;
  for (VirtualRobotCell cell = booted; cell.cycle.report().mode != Mode::kRunning; cell.step())
    ASSERT_LT(++cycles_to_run, 1000);
  ASSERT_GE(cycles_to_run, kLongest);
  int seen_running = 0;
  for (int before = 0; before < kLongest; ++before) {
    VirtualRobotCell cell = booted;
    for (int i = 0; i < cycles_to_run - before; ++i) cell.step();
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 3) frame.id = 0x7FF;
    };
    constexpr int kLatest = 20 + 2;  // the largest age, and two cycles to see it
    for (int i = 0; i < kLatest; ++i) {
      cell.step();
      seen_running += cell.cycle.report().mode == Mode::kRunning ? 1 : 0;
    }
    EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileStale) << before;
    EXPECT_NE(cell.cycle.report().mode, Mode::kRunning) << before;
  }
  EXPECT_GT(seen_running, 100);
}

/// The loop does not run for so many cycles, and the world goes on.
void pause(VirtualRobotCell& cell, int cycles) {
  cell.plant.advance(cell.t_ns += cycles * 1'000'000LL);
  cell.input.missed_cycles = cycles;
  cell.step();
  cell.input.missed_cycles = 0;
}

/// One that ended in time is over, however old the sample was with which the motion began.
TEST(ControlCycleTactileSilence, BeforeTheMotionIsNoPartOfALaterOne) {
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace().brake.emplace();
  VirtualRobotCell booted(scene);
  ASSERT_TRUE(booted.runUntil(Mode::kEnabling, 5000));
  const auto mute = [](int bus, CanFrame& frame) {
    if (bus == 3) frame.id = 0x7FF;
  };
  int cycles_to_run = 0;
  for (VirtualRobotCell cell = booted; cell.cycle.report().mode != Mode::kRunning; cell.step())
    ASSERT_LT(++cycles_to_run, 1000);
  const auto cyclesOfSilence = [&](bool was_silent_before) {
    VirtualRobotCell cell = booted;
    for (int i = 0; i < cycles_to_run + 40; ++i) {
      const bool is_silent = i > cycles_to_run - 12 && i < cycles_to_run + 2;
      cell.on_frame = nullptr;
      if (is_silent && was_silent_before) cell.on_frame = mute;
      cell.step();
    }
    EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
    cell.on_frame = mute;
    int cycles = 0;
    for (; cycles < 100 && cell.cycle.report().fault == Fault::kNone; ++cycles) cell.step();
    return cycles;
  };
  EXPECT_EQ(cyclesOfSilence(true), cyclesOfSilence(false));
}

/// What waited to be read while the loop paused is not of now, whenever it is read.
TEST(ControlCycleTactileSilence, OfTheLoopItselfIsNotEndedByWhatHasWaitedMeanwhile) {
  Scene scene = test::shippedScene("scenario1_null_space");
  for (int bus = 0; bus < 3; ++bus) {  // drives that a pause as short as this does not stop
    Trouble& trouble = scene.troubles.emplace_back();
    trouble.kind = Trouble::Kind::kHeartbeatOnly;
    trouble.until_s = 1e3;
    trouble.bus = bus;
  }
  VirtualRobotCell running(scene);
  ASSERT_TRUE(running.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) running.step();
  const auto sequence = running.record().tactile_sequence[0];

  VirtualRobotCell shortly = running;
  pause(shortly, 20);  // as old as a sample may be
  EXPECT_GT(shortly.record().tactile_sequence[0], sequence);
  EXPECT_EQ(shortly.cycle.report().mode, Mode::kRunning);

  VirtualRobotCell paused = running;
  pause(paused, 21);
  EXPECT_EQ(paused.cycle.report().fault, Fault::kTactileStale);
  EXPECT_EQ(paused.record().tactile_sequence[0], sequence);
  paused.step();
  EXPECT_EQ(paused.record().tactile_sequence[0], sequence) << "the rest of what waited";
  paused.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3) frame.id = 0x7FF;
  };
  for (int i = 0; i < 5; ++i) paused.step();
  EXPECT_EQ(paused.record().tactile_sequence[0], sequence) << "nothing new has come";
  paused.on_frame = nullptr;
  for (int i = 0; i < 5; ++i) paused.step();
  EXPECT_GT(paused.record().tactile_sequence[0], sequence);
}

Scene sceneThatBearsPauses() {
  Scene scene = test::shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace().brake.emplace();
  scene.hardware->gpio->enable.emplace();
  for (int bus = 0; bus < 3; ++bus) {
    Trouble& trouble = scene.troubles.emplace_back();
    trouble.kind = Trouble::Kind::kHeartbeatOnly;
    trouble.until_s = 1e3;
    trouble.bus = bus;
  }
  return scene;
}

/// The first sample that comes after what two cycles read is of now, and is taken at once.
TEST(ControlCycleTactileSilence, OfTheLoopItselfEndsWithTheFirstSampleAfterIt) {
  VirtualRobotCell running(sceneThatBearsPauses());
  ASSERT_TRUE(running.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1000; ++i) running.step();
  int at_once = 0;
  for (int phase = 0; phase < 4; ++phase, running.step()) {
    VirtualRobotCell cell = running;
    const auto newest = [&] { return cell.cycle.robot().tactileModules()[0].sample().sequence; };
    pause(cell, 21);
    cell.step();
    const auto waited = newest();
    int cycles = 0;
    for (; cycles < 10 && newest() == waited; ++cycles) cell.step();
    ASSERT_NE(newest(), waited);
    EXPECT_EQ(cell.record().tactile_sequence[0], newest()) << phase;
    at_once += cycles == 1 ? 1 : 0;
  }
  EXPECT_GT(at_once, 0);
}

/// An arm that waits for its start has time for a new sample; one that is about to move has none.
TEST(ControlCycleTactileSilence, OfTheLoopItselfMattersOnceDrivesSwitchOn) {
  VirtualRobotCell cell(sceneThatBearsPauses());
  cell.input.lines.enable = false;
  ASSERT_TRUE(cell.runUntil(Mode::kReady, 5000));
  for (int i = 0; i < 10; ++i) cell.step();
  pause(cell, 21);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone);
  for (int i = 0; i < 10; ++i) cell.step();
  EXPECT_EQ(cell.cycle.report().mode, Mode::kReady);
  cell.input.lines.enable = true;
  ASSERT_TRUE(cell.runUntil(Mode::kEnabling, 5));
  pause(cell, 21);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileStale);
}

}  // namespace
}  // namespace tactus
