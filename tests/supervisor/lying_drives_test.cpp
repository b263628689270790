#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// Drives that deceive the daemon, one at a time, in a cell whose other drives are honest.
namespace tactus {
namespace {

using test::VirtualRobotCell;
using Kind = Trouble::Kind;

constexpr int kDeadline = 500;  // cycles, the default of stop_deadline_s
constexpr double kAtRest = 1e-6;

Trouble troubleOf(Kind kind, double from_s, double until_s, int bus, std::uint32_t node) {
  Trouble trouble;
  trouble.kind = kind;
  trouble.from_s = from_s;
  trouble.until_s = until_s;
  trouble.bus = bus;
  trouble.id = node;
  return trouble;
}

Scene sceneWith(const std::vector<Trouble>& troubles, bool has_enable_line) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->brake.emplace();
  if (has_enable_line) scene.hardware->gpio->enable.emplace();
  scene.troubles = troubles;
  return scene;
}

void passCycles(VirtualRobotCell& cell, int cycles) {
  for (int i = 0; i < cycles; ++i) cell.step();
}

double fastest(const VirtualRobotCell& cell) {
  double speed = 0.0;
  for (int joint = 0; joint < 9; ++joint)
    speed = std::max(speed, std::abs(cell.plant.drive(joint).velocity()));
  return speed;
}

/// As if somebody had pushed this joint's limp link, of 1e6 counts a rad.
void pushJoint(VirtualRobotCell& cell, int bus, std::uint32_t id, double angle_rad) {
  cell.on_frame = [=](int at, CanFrame& frame) {
    if (at != bus || frame.id != id) return;
    std::int32_t position = 0;
    std::memcpy(&position, frame.data.data() + 2, sizeof(position));
    position += static_cast<std::int32_t>(1e6 * angle_rad);
    std::memcpy(frame.data.data() + 2, &position, sizeof(position));
  };
}

/// E-stop while joint 1's drive deceives; joint 5 is pushed; the trouble goes; off and on again.
TEST(LyingDrive, DoesNotVouchForTheOthers) {
  for (const Kind kind : {Kind::kNonsenseStatus, Kind::kFreezeFeedback, Kind::kIgnoreCommands}) {
    for (const double angle_rad : {0.3, -0.3, 0.03}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(kind)));
      VirtualRobotCell cell(sceneWith({troubleOf(kind, 6.0, 8.0, 0, 1)}, true));
      ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
      while (!cell.plant.wasEnabled()) cell.step();
      passCycles(cell, 6100);
      cell.input.lines.emergency_stop = true;
      passCycles(cell, 700);
      pushJoint(cell, 1, 0x182, angle_rad);
      passCycles(cell, 2500);
      cell.input.lines.emergency_stop = false;
      cell.switchEnable();
      for (int i = 0; i < 4000; ++i) {
        cell.step();
        ASSERT_EQ(cell.largestSetpoint(), 0) << i;
        ASSERT_NE(cell.cycle.report().mode, Mode::kEnabling) << i;
      }
      EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart)
          << faultName(cell.cycle.report().fault);
      EXPECT_EQ(cell.cycle.report().joint, 4);
      cell.on_frame = nullptr;  // and is put back
      cell.switchEnable();
      EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000)) << faultName(cell.cycle.report().fault);
    }
  }
}

/// A spoilt setpoint throws a joint far beyond any stop: its place is none to start from, though
/// its drive has held it all the time.
TEST(LyingDrive, ThatWentFurtherThanAnyStopIsNotInPlace) {
  VirtualRobotCell cell(sceneWith({}, true));
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  passCycles(cell, 1000);
  int spoilt = 0;
  cell.on_send = [&spoilt](int bus, CanFrame& frame) {
    if (bus == 1 && frame.id == 0x202 && spoilt < 100) {
      const std::int32_t counts = 5'000'000;  // 5 rad/s
      std::memcpy(frame.data.data() + 2, &counts, sizeof(counts));
      ++spoilt;
    }
    return true;
  };
  passCycles(cell, 1500);
  ASSERT_EQ(cell.cycle.report().fault, Fault::kFollowingError);
  cell.switchEnable();
  for (int i = 0; i < 3000; ++i) {
    cell.step();
    ASSERT_EQ(cell.largestSetpoint(), 0) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
  EXPECT_EQ(cell.cycle.report().joint, 4);
}

/// Of a drive's frames: the position of the first in all.
class StandingPosition {
 public:
  void putInto(CanFrame& frame) {
    if (!has_kept_) std::copy_n(frame.data.begin() + 2, 4, kept_.begin());
    has_kept_ = true;
    std::copy_n(kept_.begin(), 4, frame.data.begin() + 2);
  }

 private:
  std::array<std::uint8_t, 4> kept_{};
  bool has_kept_ = false;
};

/// Its position stands still from the start of motion on, until that is a following error. Once
/// limp the joint may be pushed to just where its feedback stood: nobody held it there.
TEST(LyingDrive, WhosePositionStoodStillIsNotInPlaceThere) {
  Scene scene = sceneWith({}, true);
  for (DriveConfig& drive : scene.hardware->drives) drive.max_following_error = 0.05;
  scene.hardware->start_tolerance = 0.02;
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  StandingPosition position;
  cell.on_frame = [&](int bus, CanFrame& frame) {
    if (bus == 0 && frame.id == 0x181) position.putInto(frame);
  };
  ASSERT_TRUE(cell.runUntil(Mode::kFault, 10000));
  ASSERT_EQ(cell.cycle.report().fault, Fault::kFollowingError);
  passCycles(cell, 1000);
  cell.switchEnable();
  for (int i = 0; i < 1000; ++i) {
    cell.step();
    ASSERT_NE(cell.cycle.report().mode, Mode::kEnabling) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
}

/// The same where another drive fails in that very cycle, and is the one that is named.
TEST(LyingDrive, WhosePositionStoodStillIsNotInPlaceThereThoughAnotherOneFailed) {
  Scene scene = sceneWith({}, true);
  for (DriveConfig& drive : scene.hardware->drives) drive.max_following_error = 0.05;
  scene.hardware->start_tolerance = 0.02;
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  StandingPosition position;
  bool has_failed = false;
  cell.on_frame = [&](int bus, CanFrame& frame) {
    if (bus == 0 && frame.id == 0x181 && has_failed) frame.data[0] = 0x18;  // fault
    if (bus == 0 && frame.id == 0x182) position.putInto(frame);
  };
  for (int i = 0; i < 10000 && cell.cycle.report().mode == Mode::kRunning; ++i) {
    const CycleRecord record = cell.record();
    const double q_next = record.q[1] + scene.period_s * record.dq[1];
    has_failed = std::abs(q_next - record.q_measured[1]) > 0.05;
    cell.step();
  }
  ASSERT_EQ(cell.cycle.report().fault, Fault::kDriveFault);
  ASSERT_EQ(cell.cycle.robot().drive(1).fault, Fault::kFollowingError);
  passCycles(cell, 1000);
  has_failed = false;
  cell.switchEnable();
  for (int i = 0; i < 1000; ++i) {
    cell.step();
    ASSERT_NE(cell.cycle.report().mode, Mode::kEnabling) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
  EXPECT_EQ(cell.cycle.report().joint, 1);
}

/// What their drives held while they stopped is where the others are, further from the last command
/// than an arm may stand that nobody held.
TEST(LyingDrive, IsNoReasonToDoubtTheOthers) {
  Scene scene = sceneWith({}, true);
  scene.hardware->start_tolerance = 2e-4;
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  passCycles(cell, 2000);
  bool has_failed = true;
  cell.on_frame = [&](int bus, CanFrame& frame) {
    if (bus == 0 && frame.id == 0x181 && has_failed) frame.data[0] = 0x18;
  };
  const CycleRecord last = cell.record();
  passCycles(cell, 1000);
  ASSERT_EQ(cell.cycle.report().fault, Fault::kDriveFault);
  double furthest = 0.0;
  for (int joint = 1; joint < 9; ++joint)
    furthest = std::max(furthest, std::abs(cell.record().q_measured[joint] - last.q[joint]));
  EXPECT_GT(furthest, 1.5 * scene.hardware->start_tolerance) << "this test is blind";
  has_failed = false;
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000)) << faultName(cell.cycle.report().fault);
}

/// A fault of another drive while this one ignores what it is told, and moves on.
TEST(LyingDrive, ThatMovesOnIsBrakedAndStoppedInTime) {
  for (const int joint : {0, 1, 4, 8}) {  // two of them fast
    const int bus = joint / 3;
    const auto node = static_cast<std::uint32_t>(joint % 3 + 1);
    VirtualRobotCell cell(sceneWith({troubleOf(Kind::kIgnoreCommands, 3.0, 60.0, bus, node),
                                     troubleOf(Kind::kDriveFault, 3.05, 3.1, (bus + 1) % 3, 1)},
                                    true));
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    ASSERT_TRUE(cell.runUntil(Mode::kFault, 4000));
    const double speed = std::abs(cell.plant.drive(joint).velocity());
    ASSERT_GT(speed, 1e-3) << "it has something to go on with";
    ASSERT_TRUE(cell.cycle.lines().release_brake);
    int brake_cycles = 0;
    while (cell.cycle.lines().release_brake && brake_cycles < 2 * kDeadline) {
      cell.step();
      ++brake_cycles;
    }
    EXPECT_LE(brake_cycles, speed > 0.025 ? 130 : kDeadline) << joint;  // 0.02 in two windows
    passCycles(cell, 250);
    EXPECT_LE(fastest(cell), kAtRest) << joint;
    for (int i = 0; i < 3000; ++i) {
      cell.step();
      ASSERT_FALSE(cell.cycle.lines().release_brake);
      ASSERT_LE(fastest(cell), kAtRest);
    }
  }
}

/// It rests with power, and says so: nothing is seen off, and the brake may not wait for it.
TEST(LyingDrive, ThatNeverSwitchesOffKeepsNoBrakeOpen) {
  for (const bool has_enable_line : {false, true}) {
    Scene scene = sceneWith({troubleOf(Kind::kIgnoreCommands, 0.1, 1e3, 1, 2)}, has_enable_line);
    const int deadline = has_enable_line ? 700 : kDeadline;
    scene.hardware->canopen.stop_deadline_s = 0.001 * deadline;
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    passCycles(cell, 200);
    cell.input.are_lines_lost = true;  // a quick stop
    passCycles(cell, deadline - 10);
    EXPECT_TRUE(cell.cycle.lines().release_brake) << "it may yet hold its joint";
    passCycles(cell, 11);
    EXPECT_FALSE(cell.cycle.lines().release_brake);
    passCycles(cell, 200);
    EXPECT_LE(fastest(cell), kAtRest);
    EXPECT_NE(cell.plant.drive(4).powerState(), PowerState::kOperationEnabled) << "cut off";
    if (!has_enable_line) {
      EXPECT_TRUE(cell.cycle.isFinished());
    }
  }
}

/// The deadlines are of time: a loop that misses cycles meanwhile has fewer of them.
TEST(LyingDrive, ThatNeverSwitchesOffIsCutOffInTimeThoughCyclesAreMissed) {
  VirtualRobotCell cell(sceneWith({troubleOf(Kind::kIgnoreCommands, 0.1, 1e3, 1, 2)}, true));
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  passCycles(cell, 200);
  cell.input.are_lines_lost = true;
  passCycles(cell, 1);
  ASSERT_EQ(cell.cycle.report().mode, Mode::kFault);
  constexpr int kMissed = 4;  // each time, just before a cycle
  cell.input.missed_cycles = kMissed;
  for (int passed = 0; passed <= kDeadline; passed += kMissed + 1) {
    cell.t_ns += kMissed * 1'000'000;
    cell.step();
  }
  EXPECT_FALSE(cell.cycle.lines().release_brake);
  passCycles(cell, 40);
  EXPECT_NE(cell.plant.drive(4).powerState(), PowerState::kOperationEnabled) << "cut off";
}

TEST(LyingDrive, ThatSaysItBootsIsResetAndDoesNotRunAgainstTheBrake) {
  for (const int joint : {1, 5}) {
    VirtualRobotCell cell(sceneWith(
        {troubleOf(Kind::kBootUp, 5.0, 5.1, joint / 3, static_cast<std::uint32_t>(joint % 3 + 1))},
        true));
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    ASSERT_TRUE(cell.runUntil(Mode::kFault, 6000));
    EXPECT_EQ(cell.cycle.report().fault, Fault::kDriveStateLost);
    EXPECT_EQ(cell.cycle.report().joint, joint);
    passCycles(cell, 5);
    EXPECT_NE(cell.plant.drive(joint).powerState(), PowerState::kOperationEnabled);
    passCycles(cell, 400);
    EXPECT_LE(fastest(cell), kAtRest);
    EXPECT_FALSE(cell.cycle.lines().release_brake);
    cell.switchEnable();
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 4000)) << faultName(cell.cycle.report().fault);
  }
}

/// Off is reached by time while a drive still moves; nothing but its heartbeat watch stops it.
TEST(LyingDrive, KeepsItsOwnWatchBeyondTheEnd) {
  for (const bool is_stopped : {false, true}) {
    VirtualRobotCell cell(sceneWith({troubleOf(Kind::kIgnoreCommands, 5.0, 1e3, 1, 2),
                                     troubleOf(Kind::kHeartbeatOnly, 0.0, 1e3, 1, 2)},
                                    false));
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    passCycles(cell, 5200);
    ASSERT_GT(std::abs(cell.plant.drive(4).velocity()), 1e-3);
    bool is_disarmed = false;
    cell.on_send = [&is_disarmed](int bus, CanFrame& frame) {  // NMT does not get through
      const bool is_nmt = bus == 1 && frame.id == 0;
      const bool is_its = frame.data[1] == 0 || frame.data[1] == 2;
      is_disarmed = is_disarmed || (is_nmt && is_its && frame.data[0] == 130);
      return !is_nmt;
    };
    if (is_stopped) {
      cell.input.stop_requested = true;
    } else {
      cell.input.are_lines_lost = true;
    }
    for (int i = 0; i < 8000 && !cell.cycle.isFinished(); ++i) cell.step();
    ASSERT_TRUE(cell.cycle.isFinished());
    for (int i = 0; i < 500; ++i) cell.plant.advance(cell.t_ns += 1'000'000);
    EXPECT_LE(fastest(cell), kAtRest) << is_stopped;
    EXPECT_FALSE(is_disarmed) << "reset communication would end its heartbeat watch";
  }
}

}  // namespace
}  // namespace tactus
