#include <gtest/gtest.h>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// What the report says of a fault: time, place, value and limit.
namespace tactus {
namespace {

using test::VirtualRobotCell;

VirtualRobotCell runningArm() {
  VirtualRobotCell cell(test::shippedScene("scenario1_multi_space"));
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 200; ++i) cell.step();
  EXPECT_TRUE(std::isnan(cell.cycle.report().time_s)) << "no fault yet";
  return cell;
}

/// The report of the first cycle with a fault, which has the time of that cycle's record.
ModeReport firstFault(VirtualRobotCell& cell) {
  for (int i = 0; i < 100 && cell.cycle.report().fault == Fault::kNone; ++i) cell.step();
  const ModeReport report = cell.cycle.report();
  EXPECT_EQ(report.time_s, cell.record().t_s);
  EXPECT_EQ(cell.record().fault, static_cast<std::uint64_t>(report.fault));
  for (int i = 0; i < 50; ++i) cell.step();
  EXPECT_EQ(cell.cycle.report().time_s, report.time_s) << "it stays that of the fault";
  EXPECT_EQ(cell.cycle.report().detail.value, report.detail.value);
  return report;
}

void spoilFrames(VirtualRobotCell& cell, int bus, std::uint32_t id, std::size_t byte,
                 std::uint8_t flip) {
  cell.on_frame = [=](int of_bus, CanFrame& frame) {
    if (of_bus == bus && frame.id == id) frame.data[byte] ^= flip;
  };
}

TEST(FaultDetails, OfAForceBeyondTheRange) {
  VirtualRobotCell cell = runningArm();
  cell.on_frame = [](int bus, CanFrame& frame) {  // 80 N on each of two cells of one side
    if (bus != 3 || (frame.id != 0x100 && frame.id != 0x102)) return;
    frame.data[2] = 0x00;
    frame.data[3] = 0x12;
    frame.data[4] = 0x7A;
  };
  const ModeReport report = firstFault(cell);
  EXPECT_EQ(report.fault, Fault::kTactileInvalid);
  EXPECT_GT(report.detail.value, report.detail.limit);
  EXPECT_LT(report.detail.value, 1e4);
  EXPECT_EQ(
      report.detail.limit,
      test::shippedScene("scenario1_multi_space").controller.tactile_modules.front().max_force_N);
  EXPECT_STREQ(report.detail.unit, "N");
  EXPECT_EQ(report.joint, -1);
  EXPECT_EQ(report.drive.fault, Fault::kNone) << "it speaks of no drive";
  EXPECT_EQ(report.q_measured, 0.0);
  EXPECT_EQ(report.q_expected, 0.0);
}

/// Also of an arm at rest, where the controller does not answer it.
TEST(FaultDetails, OfAForceAtRestNameItsModule) {
  struct OnBus {
    int bus;
    std::uint32_t id;
  };
  int module = 0;
  for (const OnBus& place : {OnBus{3, 0x100}, OnBus{3, 0x110}, OnBus{4, 0x100}}) {
    Scene scene = test::shippedScene("whole_arm/crops9_skin_two_links");
    scene.hardware->gpio.emplace().enable.emplace();
    VirtualRobotCell cell(scene);
    cell.input.lines.enable = false;
    ASSERT_TRUE(cell.runUntil(Mode::kReady, 5000));
    cell.on_frame = [place](int bus, CanFrame& frame) {
      if (bus != place.bus || (frame.id != place.id && frame.id != place.id + 2)) return;
      frame.data[2] = 0x00;
      frame.data[3] = 0x12;
      frame.data[4] = 0x7A;
    };
    for (int i = 0; i < 100 && cell.cycle.report().fault == Fault::kNone; ++i) cell.step();
    EXPECT_EQ(cell.cycle.report().fault, Fault::kTactileInvalid);
    EXPECT_EQ(cell.cycle.report().detail.module, module++);
    EXPECT_GT(cell.cycle.report().detail.value, cell.cycle.report().detail.limit);
    EXPECT_STREQ(cell.cycle.report().detail.unit, "N");
  }
}

TEST(FaultDetails, OfASampleTooOld) {
  VirtualRobotCell cell = runningArm();
  spoilFrames(cell, 3, 0x100, 0, 0x80);
  const ModeReport report = firstFault(cell);
  EXPECT_EQ(report.fault, Fault::kTactileStale);
  EXPECT_GT(report.detail.value, report.detail.limit);
  EXPECT_LT(report.detail.value, report.detail.limit + 0.0015) << "the first cycle too old";
  EXPECT_STREQ(report.detail.unit, "s");
}

/// Just as old as it may be, it is none too old.
TEST(FaultDetails, OfASampleTooOldByACycle) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  double& max_age_s = scene.controller.tactile_modules[0].max_sample_age_s;
  double before_s = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (i > 0) max_age_s = before_s;  // the age that was the first too old
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    spoilFrames(cell, 3, 0x100, 0, 0x80);
    const ModeReport report = firstFault(cell);
    EXPECT_EQ(report.fault, Fault::kTactileStale);
    const double expected_s = i > 0 ? before_s + scene.period_s : report.detail.value;
    EXPECT_NEAR(report.detail.value, expected_s, 1e-9);
    before_s = report.detail.value;
  }
}

TEST(FaultDetails, OfAJointThatDoesNotFollow) {
  VirtualRobotCell cell = runningArm();
  spoilFrames(cell, 1, 0x182, 4, 0x10);
  const ModeReport report = firstFault(cell);
  EXPECT_EQ(report.fault, Fault::kFollowingError);
  EXPECT_EQ(report.joint, 4);
  EXPECT_NEAR(report.detail.value, std::abs(report.q_measured - report.q_expected), 1e-3);
  EXPECT_GT(report.detail.value, report.detail.limit);
  EXPECT_STREQ(report.detail.unit, "rad");
}

TEST(FaultDetails, OfAJointThatIsNotAtItsStart) {
  for (const int joint : {0, 8}) {
    Scene scene = test::shippedScene("scenario1_multi_space");
    VirtualRobotCell cell(scene);  // its plant stands where the scene starts
    scene.controller.q_start[joint] += 0.03;
    cell.cycle = ControlCycle(scene.controller, *scene.hardware, scene.period_s);
    for (int i = 0; i < 5000 && cell.cycle.report().fault == Fault::kNone; ++i) cell.step();
    const ModeReport& report = cell.cycle.report();
    EXPECT_EQ(report.fault, Fault::kNotAtStart);
    EXPECT_EQ(report.joint, joint);
    EXPECT_NEAR(report.detail.value, 0.03, 1e-4);
    EXPECT_EQ(report.detail.limit, scene.hardware->start_tolerance);
    EXPECT_STREQ(report.detail.unit, unitOf(scene.controller.chain.type(joint)));
  }
}

TEST(FaultDetails, OfALoopThatIsLate) {
  VirtualRobotCell cell = runningArm();
  cell.input.late_in_a_row = 7;
  const ModeReport report = firstFault(cell);
  EXPECT_EQ(report.fault, Fault::kOverrun);
  EXPECT_EQ(report.detail.value, 7.0);
  EXPECT_EQ(report.detail.limit, 3.0);
  EXPECT_STREQ(report.detail.unit, "cycles");
}

TEST(FaultDetails, OfADrivesEmergency) {
  VirtualRobotCell cell = runningArm();
  bool is_sent = false;
  cell.on_frame = [&is_sent](int bus, CanFrame& frame) {
    if (bus != 1 || frame.id != 0x182 || is_sent) return;
    frame.id = 0x82;
    frame.size = 8;
    frame.data = {0x11, 0x86, 0x81, 0, 0, 0, 0, 0};
    is_sent = true;
  };
  const ModeReport report = firstFault(cell);
  EXPECT_EQ(report.fault, Fault::kDriveFault);
  EXPECT_EQ(report.joint, 4);
  EXPECT_EQ(report.detail.value, 0x8611);
  EXPECT_STREQ(report.detail.unit, "emergency code");
}

TEST(FaultDetails, BeforeMotionHaveNoTime) {
  VirtualRobotCell cell(test::shippedScene("scenario1_multi_space"));
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3 && frame.id == 0x100) frame.data[4] = 5;  // a hand on the cover
  };
  for (int i = 0; i < 5000 && cell.cycle.report().fault == Fault::kNone; ++i) cell.step();
  const ModeReport& report = cell.cycle.report();
  EXPECT_EQ(report.fault, Fault::kTareRefused);
  EXPECT_TRUE(std::isnan(report.time_s));
  EXPECT_GT(report.detail.value, report.detail.limit);
  const Scene scene = test::shippedScene("scenario1_multi_space");
  EXPECT_EQ(report.detail.limit, scene.hardware->tactile_modules.front().tare_max_offset_N);
}

TEST(FaultDetails, AreGoneOnceItIsCleared) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.input.late_in_a_row = 7;
  cell.step();
  ASSERT_EQ(cell.cycle.report().fault, Fault::kOverrun);
  cell.input.late_in_a_row = 0;
  for (int i = 0; i < 1000; ++i) cell.step();
  cell.switchEnable();
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 4000));
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone);
  EXPECT_STREQ(cell.cycle.report().detail.unit, "");
  EXPECT_TRUE(std::isnan(cell.cycle.report().time_s));
}

/// The joint that the controller names is that of the whole report.
TEST(FaultDetails, OfACommandThatIsNoNumber) {
  VirtualRobotCell cell = runningArm();
  Gains gains = test::shippedScene("scenario1_multi_space").controller.gains;
  gains.task.drift_gain_per_s = std::nan("");
  cell.cycle.tune(gains);
  for (int i = 0; i < 2; ++i) cell.step();
  const ModeReport report = cell.cycle.report();
  EXPECT_EQ(report.fault, Fault::kCommandNotFinite);
  ASSERT_GE(report.detail.joint, 0);
  EXPECT_EQ(report.joint, report.detail.joint);
  EXPECT_NE(report.q_measured, 0.0);
  EXPECT_NEAR(report.q_measured, report.q_expected, 0.05);
}

/// Drives that never hear a control word: time is over, no drive has said anything wrong, and the
/// first that is waited for is named.
TEST(FaultDetails, OfATimeLimitSpeakOfTheDriveThatIsWaitedFor) {
  VirtualRobotCell cell(test::shippedScene("scenario1_multi_space"));
  cell.on_send = [](int, CanFrame& frame) { return frame.id < 0x200 || frame.id >= 0x280; };
  for (int i = 0; i < 20000 && cell.cycle.report().fault == Fault::kNone; ++i) cell.step();
  const ModeReport report = cell.cycle.report();
  EXPECT_EQ(report.fault, Fault::kDriveStateLost);
  EXPECT_EQ(report.joint, 0);
  EXPECT_EQ(report.bus, -1);
  EXPECT_EQ(report.detail.joint, -1);
}

}  // namespace
}  // namespace tactus
