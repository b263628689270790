#include <gtest/gtest.h>

#include <cmath>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

/// What a cycle tells of itself: lines, buses, late cycles, the tool, and how gains do.
namespace tactus {
namespace {

using test::VirtualRobotCell;

Scene emptyScene(const char* name) {
  return test::shippedScene(name, {{"simulation.obstacles", "[]"}});
}

VirtualRobotCell movingCell(const Scene& scene) {
  VirtualRobotCell cell(scene);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 1500; ++i) cell.step();
  return cell;
}

TEST(CycleReports, TheHeartbeatLineChangesEachCycle) {
  VirtualRobotCell cell(emptyScene("scenario1_null_space"));
  for (int i = 0; i < 10; ++i) {
    const bool before = cell.cycle.lines().heartbeat;
    cell.step();
    EXPECT_NE(cell.cycle.lines().heartbeat, before) << i;
  }
}

TEST(CycleReports, ABusFaultNamesItsBus) {
  for (const int bus : {0, 2}) {
    VirtualRobotCell cell = movingCell(emptyScene("scenario1_null_space"));
    cell.exchangeInput();
    cell.input.bus_faults[bus] = Fault::kBusOff;
    cell.cycle.update(cell.input);
    EXPECT_EQ(cell.cycle.report().fault, Fault::kBusOff);
    EXPECT_EQ(cell.cycle.report().bus, bus);
    EXPECT_EQ(cell.cycle.report().joint, -1);
  }
}

TEST(CycleReports, WhoAcknowledgesTooEarlyIsToldWhatTheArmWaitsFor) {
  Scene scene = emptyScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  VirtualRobotCell cell = movingCell(scene);
  const ControlCycle& cycle = cell.cycle;
  EXPECT_EQ(cycle.wayOn().waits_for, WaitsFor::kNothing);
  cell.input.lines.emergency_stop = true;
  cell.step();
  EXPECT_EQ(cycle.wayOn().waits_for, WaitsFor::kFaultGone);
  EXPECT_EQ(cycle.wayOn().fault, Fault::kEmergencyStop);
  cell.input.lines.emergency_stop = false;
  for (const bool enable : {false, true}) {
    cell.input.lines.enable = enable;
    cell.step();
    EXPECT_EQ(cycle.wayOn().waits_for, WaitsFor::kDrivesOff);
  }
  for (int i = 0; i < 5000 && cycle.wayOn().waits_for == WaitsFor::kDrivesOff; ++i) cell.step();
  for (int i = 0; i < 100; ++i) cell.step();
  EXPECT_EQ(cycle.report().mode, Mode::kFault);
  EXPECT_EQ(cycle.wayOn().waits_for, WaitsFor::kEnableOff);
  cell.input.lines.enable = false;
  cell.step();
  EXPECT_EQ(cycle.wayOn().waits_for, WaitsFor::kEnableOn);
  cell.input.lines.enable = true;
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  EXPECT_EQ(cycle.wayOn().waits_for, WaitsFor::kNothing);
}

/// As many late cycles as it may have are none too many, and none counts before an arm may move.
TEST(CycleReports, LateCyclesCountOneByOne) {
  const Scene scene = emptyScene("scenario1_null_space");
  VirtualRobotCell cell(scene);
  cell.input.late_in_a_row = 9;
  for (int i = 0; i < 20; ++i) cell.step();
  EXPECT_EQ(cell.cycle.report().mode, Mode::kBoot);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone);
  cell.input.late_in_a_row = 0;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.input.late_in_a_row = scene.hardware->real_time.max_late_cycles;
  cell.step();
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone);
  ++cell.input.late_in_a_row;
  cell.step();
  EXPECT_EQ(cell.cycle.report().fault, Fault::kOverrun);
}

/// For those who tell a tool where to go: the motion that they order starts there.
TEST(CycleReports, ShowWhereTheToolIs) {
  const Scene scene = emptyScene("commands");
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.cycle.prepare();
  ToolSight sight;
  cell.cycle.fill(sight);
  ToolOrder order;
  order.number = 7;
  order.kind = ToolOrder::Kind::kGo;
  order.run = sight.run;
  std::copy_n(sight.p_BaseTool_m, 3, order.p_BaseTool_m);
  std::copy_n(sight.R_BaseTool, 9, order.R_BaseTool);
  order.p_BaseTool_m[1] += 0.1;
  cell.cycle.order(order);
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3 && frame.id == 0x100) frame.data[4] = 1;  // 0.66 N, which is no contact
  };
  for (int i = 0; i < 500; ++i) {
    cell.step();
    cell.cycle.prepare();
  }
  const CycleRecord now = cell.record();
  cell.cycle.fill(sight);
  EXPECT_EQ(sight.report, (ToolReport{7, ToolState::kMoving, 0}));
  EXPECT_TRUE(sight.is_running);
  EXPECT_GT(sight.force_N[0], 0.1) << "it feels nothing: this test is blind";
  EXPECT_EQ(sight.force_N[0], now.force_sensor_N[0]);
  EXPECT_EQ(sight.position_m[0], now.contact_position_m[0]);
  cell.step();
  const CycleRecord next = cell.record();
  for (int i = 0; i < scene.controller.chain.size(); ++i) EXPECT_EQ(sight.q[i], next.q[i]) << i;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(sight.p_BaseTool_m[i], next.wd[i], 1e-12) << "of its reference";
    EXPECT_GT(std::abs(next.wd_dot[1]), 0.05) << "it does not move: this test is blind";
  }
}

/// For 3 s, at rest.
void tryGainsUnderForce(const Scene& scene, VirtualRobotCell& cell) {
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3 && frame.id == 0x100) frame.data[4] = 5;  // 3.3 N
  };
  GainOrder order{.number = 1, .gains = scene.controller.gains};
  order.gains.force.time_constant_s = 0.11;
  cell.cycle.order(order);
  for (int i = 0; i < 3000; ++i) cell.step();
}

/// Pushed by the same force all the time, an arm whose joints may move slowly only is at their
/// limits. New gains are taken back for that, and not where there is none.
TEST(CycleReports, GainsAreTakenBackAtLimitsOfSpeed) {
  for (const double most : {1e-3, 10.0}) {
    Scene scene = emptyScene("scenario1_null_space");
    scene.controller.limits.max_velocity.setConstant(most);
    scene.controller.task.trajectory.waypoints.clear();
    VirtualRobotCell cell(scene);
    tryGainsUnderForce(scene, cell);
    EXPECT_EQ(cell.cycle.gainReport().trouble,
              most < 1.0 ? GainTrouble::kAtLimits : GainTrouble::kNone)
        << most;
    EXPECT_EQ(cell.cycle.report().fault, Fault::kNone);
    if (most < 1.0) continue;
    cell.input.lines.emergency_stop = true;
    for (int i = 0; i < 3; ++i) cell.step();
    EXPECT_EQ(cell.cycle.gainReport().trouble, GainTrouble::kFault);
  }
}

/// Each of its joints counts.
TEST(CycleReports, GainsAreTakenBackAtTheLimitOfOneJoint) {
  for (const int joint : {0, 8}) {
    Scene scene = emptyScene("scenario1_null_space");
    scene.controller.limits.max_velocity.setConstant(10.0);
    scene.controller.limits.max_velocity[joint] = 1e-5;
    scene.controller.task.trajectory.waypoints.clear();
    VirtualRobotCell cell(scene);
    tryGainsUnderForce(scene, cell);
    EXPECT_EQ(cell.cycle.gainReport().trouble, GainTrouble::kAtLimits) << joint;
  }
}

/// An arm that can feel tries new gains in contact alone; they are its own meanwhile.
TEST(CycleReports, GainsAreOnTrialUntilThereWasContact) {
  const Scene scene = emptyScene("scenario1_null_space");
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  GainOrder order{.number = 1, .gains = scene.controller.gains};
  order.gains.force.time_constant_s = 0.11;
  cell.cycle.order(order);
  for (int i = 0; i < 6000; ++i) cell.step();
  EXPECT_EQ(cell.cycle.gainReport().state, GainState::kOnTrial);
  EXPECT_EQ(cell.record().gains.force.time_constant_s, 0.11);
  cell.on_frame = [](int bus, CanFrame& frame) {
    if (bus == 3 && frame.id == 0x100) frame.data[4] = 5;  // 3.3 N
  };
  for (int i = 0; i < 4500; ++i) cell.step();
  EXPECT_EQ(cell.cycle.gainReport().state, GainState::kKept);
  EXPECT_EQ(cell.cycle.gainReport().trouble, GainTrouble::kNone);
}

/// One that has no law for what it feels tries them by moving.
TEST(CycleReports, GainsOfAnArmWithoutALawAreKeptAfterAWhile) {
  const Scene scene = emptyScene("scenario1_none");
  ASSERT_FALSE(scene.controller.force_control);
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  GainOrder order{.number = 1, .gains = scene.controller.gains};
  order.gains.task.drift_gain_per_s *= 1.1;
  cell.cycle.order(order);
  for (int i = 0; i < 6000; ++i) cell.step();
  EXPECT_EQ(cell.cycle.gainReport().state, GainState::kKept);
  EXPECT_EQ(cell.cycle.gainReport().kept_number, 1U);
}

/// After the ramp drives keep the arm for 20 ms, for them to have followed it.
TEST(CycleReports, DrivesHoldForAMomentAtTheEnd) {
  Scene scene = emptyScene("scenario1_null_space");
  scene.controller.task.trajectory.waypoints.clear();
  VirtualRobotCell cell = movingCell(scene);
  cell.input.stop_requested = true;
  int cycles = 0;
  for (; cycles < 1000 && !cell.isAnyDrive(PowerState::kSwitchedOn); ++cycles) cell.step();
  EXPECT_GE(cycles, 20);
  EXPECT_LE(cycles, 26);
}

}  // namespace
}  // namespace tactus
