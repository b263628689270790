#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "support/orders_rig.h"
#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/control/module_loss.h"
#include "tactus/record/replay.h"

/// An arm with a skin that loses one of its modules on the buses: what it goes on with, and when it
/// does not.
namespace tactus {
namespace {

using test::VirtualRobotCell;

constexpr int kBefore_cycles = 2500;  ///< of motion, 2 s of it on the way; nothing touches yet
constexpr double kShare = 0.25;
constexpr std::uint64_t kLink3 = 1, kLink4 = 2, kLink6 = 4;

Scene skinScene(const std::string& reaction, std::vector<Override> more = {}) {
  more.push_back({"robot.module_lost", reaction});
  more.push_back({"controller.variant", "none"});
  return test::shippedScene("whole_arm/crops9_skin_two_links", more);
}

using OnFrame = std::function<void(int bus, CanFrame& frame)>;

/// What happens to the frames of a module of that bus.
OnFrame onModule(int bus, std::uint32_t first_id, std::function<void(CanFrame& frame)> spoil) {
  return [=](int at, CanFrame& frame) {
    if (at == bus && frame.id >= first_id && frame.id < first_id + 4) spoil(frame);
  };
}

void silence(CanFrame& frame) { frame.id = 0x7FF; }
void breakCable(CanFrame& frame) { frame.data[1] |= 2; }
void saturate(CanFrame& frame) { frame.data[1] |= 1; }

const OnFrame kNoLink3 = onModule(3, 0x100, silence);
const OnFrame kNoLink4 = onModule(3, 0x110, silence);
const OnFrame kNoLink6 = onModule(4, 0x100, silence);

/// The arm in motion, and what of it is logged.
struct SkinRun {
  explicit SkinRun(const Scene& of_scene, int cycles = kBefore_cycles)
      : scene(of_scene), cell(scene) {
    EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
    records.push_back(cell.record());
    step(cycles);
  }

  void step(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      cell.step();
      cell.cycle.prepare();
      records.push_back(cell.record());
    }
  }

  const CycleRecord& last() const { return records.back(); }
  Mode mode() const { return cell.cycle.report().mode; }
  Fault fault() const { return cell.cycle.report().fault; }

  /// Of the joints' own limits, the fastest.
  double largestSpeedShare() const {
    double largest = 0.0;
    for (int i = 0; i < scene.controller.chain.size(); ++i)
      largest = std::max(largest, std::abs(last().dq[i]) / scene.controller.limits.max_velocity[i]);
    return largest;
  }

  void expectReplay() const {
    const Controller controller(scene.controller);
    Replayer replayer(controller, scene.controller.chain.size(), scene.period_s);
    const RecordShape shape{9, 3, false, 3, false, true};
    ReplayComparison comparison(shape);
    for (const CycleRecord& recorded : records) comparison.add(recorded, replayer.replay(recorded));
    EXPECT_EQ(comparison.differingCycles(), 0);
    EXPECT_GT(comparison.cycles(), kBefore_cycles);
  }

  Scene scene;
  VirtualRobotCell cell;
  std::vector<CycleRecord> records;
};

TEST(LostModule, StopsTheArmByDefault) {
  SkinRun run(skinScene("stop"));
  run.cell.on_frame = kNoLink6;
  run.step(100);
  EXPECT_EQ(run.fault(), Fault::kTactileStale);
  EXPECT_EQ(run.cell.cycle.report().detail.module, 2);
  EXPECT_NE(run.mode(), Mode::kRunning);
  EXPECT_EQ(run.last().modules_lost, 0u);
}

TEST(LostModule, IsGoneOnWithoutUntilItHasProvenGood) {
  for (const auto spoil : {silence, breakCable}) {
    SkinRun run(skinScene("go_on_slowly"));
    run.cell.on_frame = onModule(4, 0x100, spoil);
    run.step(300);
    EXPECT_EQ(run.mode(), Mode::kRunning);
    EXPECT_EQ(run.last().modules_lost, kLink6);
    EXPECT_EQ(run.last().speed_share, kShare);
    const double path_s = run.last().path_time_s;
    run.step(1000);
    EXPECT_NEAR(run.last().path_time_s - path_s, kShare, 1e-3);
    run.cell.on_frame = nullptr;
    // A broken cable is broken until it was good for that long, and the controller wants the same.
    const int proof = spoil == silence ? 1000 : 2000;
    run.step(proof - 50);
    EXPECT_EQ(run.last().speed_share, kShare);
    run.step(50 + 300);
    EXPECT_EQ(run.last().speed_share, 1.0);
    EXPECT_EQ(run.last().modules_lost, 0u);
    EXPECT_EQ(run.fault(), Fault::kNone);
    run.expectReplay();
  }
}

TEST(LostModule, LetsNoJointBeFasterThanItsShare) {
  SkinRun run(skinScene("go_on_slowly", {{"task.trajectory.line.speed_m_per_s", "0.3"},
                                         {"robot.module_lost_speed_share", "0.02"}}),
              700);
  ASSERT_EQ(run.mode(), Mode::kRunning) << faultName(run.fault());
  run.cell.on_frame = kNoLink6;
  run.step(600);
  ASSERT_EQ(run.last().speed_share, 0.02);
  for (int i = 0; i < 500; ++i) {
    run.step(1);
    ASSERT_LE(run.largestSpeedShare(), 0.02 * (1.0 + 1e-12));
  }
}

/// It is late because it is slow, and nothing is in its way.
TEST(LostModule, DoesNotHoldTheToolOffItsTarget) {
  SkinRun run(skinScene("go_on_slowly", {{"task.source", "commands"},
                                         {"task.trajectory", "~"},
                                         {"task.max_return_speed_m_per_s", "0.05"},
                                         {"simulation.obstacles", "[]"}}),
              500);
  run.cell.on_frame = kNoLink6;
  run.step(300);
  ASSERT_EQ(run.last().modules_lost, kLink6);
  ToolSight sight;
  run.cell.cycle.fill(sight);
  ToolOrder order = test::orderTo(Vector3(sight.p_BaseTool_m) + 0.1 * Vector3::UnitY(), 1);
  order.run = sight.run;
  std::copy_n(sight.R_BaseTool, 9, order.R_BaseTool);
  run.cell.cycle.order(order);
  for (int i = 0; i < 20000 && run.cell.cycle.toolReport()->state != ToolState::kArrived; ++i) {
    run.step(1);
    ASSERT_NE(run.cell.cycle.toolReport()->state, ToolState::kBlocked) << i;
  }
  EXPECT_EQ(run.cell.cycle.toolReport()->state, ToolState::kArrived);
}

TEST(LostModule, IsForgottenWithItsContact) {
  // Lost before it touches: link 6 runs into its post unfelt, slowly.
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = kNoLink6;
  run.step(100);
  double true_N = 0.0;
  for (int i = 0; i < 18'000 && run.mode() == Mode::kRunning && true_N < 10.0; ++i) {
    run.step(1);
    true_N = run.cell.plant.world().trueForce_N(2);
    ASSERT_EQ(run.last().force_sensor_N[2], 0.0);
  }
  EXPECT_GE(true_N, 10.0) << "nothing was touched: this test is blind";
  EXPECT_EQ(run.last().modules_lost, kLink6);
}

TEST(LostModule, InAContactIsAFaultThatRetreats) {
  for (const auto spoil : {silence, breakCable}) {
    SkinRun run(skinScene("go_on_slowly"));
    while (run.records.size() < 9000 && run.last().force_sensor_N[2] < 8.0) run.step(1);
    ASSERT_GE(run.last().force_sensor_N[2], 8.0);
    run.cell.on_frame = onModule(4, 0x100, spoil);
    run.step(30);
    EXPECT_EQ(run.mode(), Mode::kRetreating);
    EXPECT_EQ(run.cell.cycle.report().detail.module, 2);
    run.step(1800);
    EXPECT_LT(run.cell.plant.world().trueForce_N(2), 0.5) << "the contact is left";
    run.expectReplay();
  }
}

TEST(LostModule, OfWhichMuchIsTooMuchToReadIsAFault) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = onModule(4, 0x100, saturate);
  run.step(30);
  EXPECT_EQ(run.fault(), Fault::kTactileSaturated);
  EXPECT_NE(run.mode(), Mode::kRunning);
}

/// A push at its rail is a push, also of one that was out of reach before.
TEST(LostModule, ThatComesBackWithTooMuchToReadIsAFault) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = kNoLink6;
  run.step(300);
  ASSERT_EQ(run.last().modules_lost, kLink6);
  run.cell.on_frame = onModule(4, 0x100, saturate);
  run.step(30);
  EXPECT_EQ(faultName(run.fault()), std::string("tactile_saturated"));
  EXPECT_EQ(run.cell.cycle.report().detail.module, 2);
  EXPECT_NE(run.mode(), Mode::kRunning);
  run.expectReplay();
}

TEST(LostModule, IsAFaultWhenNoOtherIsGood) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = [](int bus, CanFrame& frame) {
    kNoLink4(bus, frame);
    kNoLink6(bus, frame);
  };
  run.step(500);
  EXPECT_EQ(run.mode(), Mode::kRunning);
  EXPECT_EQ(run.last().modules_lost, kLink4 | kLink6);
  run.cell.on_frame = [](int bus, CanFrame& frame) {
    kNoLink3(bus, frame);
    kNoLink4(bus, frame);
    kNoLink6(bus, frame);
  };
  run.step(30);
  EXPECT_EQ(run.fault(), Fault::kTactileStale);
  EXPECT_NE(run.mode(), Mode::kRunning);
  run.expectReplay();
}

/// The first two channels of a module, far apart: a force that no arm bears.
void push(CanFrame& frame) {
  const bool is_first = frame.id % 4 == 0;
  for (int i = 2; is_first && i < 8; ++i) frame.data[i] = 0;
  if (!is_first) return;
  frame.data[4] = 0x70;  // 7.3e6 counts
  frame.data[7] = 0x90;  // and as many below 0
}

/// Whatever is wrong with the last good one: what was lost before is no news.
TEST(LostModule, IsNotNamedWhenTheLastGoodOneFails) {
  struct Failing {
    std::function<void(CanFrame& frame)> spoil;
    Fault fault;
  };
  const Failing ways[] = {{silence, Fault::kTactileStale},
                          {breakCable, Fault::kTactileCableBreak},
                          {saturate, Fault::kTactileSaturated},
                          {push, Fault::kTactileInvalid}};
  for (const Failing& failing : ways) {
    SkinRun run(skinScene("go_on_slowly"));
    run.cell.on_frame = [](int bus, CanFrame& frame) {
      kNoLink3(bus, frame);
      kNoLink4(bus, frame);
    };
    run.step(500);
    ASSERT_EQ(run.last().modules_lost, kLink3 | kLink4);
    run.cell.on_frame = [&failing](int bus, CanFrame& frame) {
      kNoLink3(bus, frame);
      kNoLink4(bus, frame);
      onModule(4, 0x100, failing.spoil)(bus, frame);
    };
    run.step(40);
    EXPECT_EQ(faultName(run.fault()), std::string(faultName(failing.fault)));
    EXPECT_EQ(run.cell.cycle.report().detail.module, 2) << faultName(failing.fault);
    EXPECT_NE(run.mode(), Mode::kRunning);
    run.expectReplay();
  }
}

TEST(LostModule, AllAtOnceAreAFault) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = [](int bus, CanFrame& frame) {
    kNoLink3(bus, frame);
    kNoLink4(bus, frame);
    kNoLink6(bus, frame);
  };
  run.step(30);
  EXPECT_EQ(run.fault(), Fault::kTactileStale);
  EXPECT_NE(run.mode(), Mode::kRunning);
}

/// With every other sample good it would never be stale.
TEST(LostModule, StaysLostWhileItsCableBreaksNowAndThen) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = onModule(4, 0x100, [](CanFrame& frame) {
    if (frame.data[0] % 2 == 0) breakCable(frame);
  });
  run.step(500);
  for (int i = 0; i < 1000; ++i) {
    run.step(1);
    ASSERT_EQ(run.last().modules_lost, kLink6);
    ASSERT_EQ(run.last().speed_share, kShare);
  }
  run.expectReplay();
}

TEST(LostModule, LeavesAllElseToEndTheRunAsEver) {
  SkinRun stopped(skinScene("go_on_slowly"));
  stopped.cell.on_frame = kNoLink6;
  stopped.step(300);
  stopped.cell.input.stop_requested = true;
  EXPECT_TRUE(stopped.cell.runUntil(Mode::kOff, 3000));
  EXPECT_EQ(stopped.fault(), Fault::kNone) << "it was asked to end, and did";

  SkinRun pressed(skinScene("go_on_slowly"));
  pressed.cell.on_frame = kNoLink6;
  pressed.step(300);
  pressed.cell.input.lines.emergency_stop = true;
  pressed.step(1);
  EXPECT_EQ(pressed.fault(), Fault::kEmergencyStop);
  EXPECT_EQ(pressed.mode(), Mode::kFault);
}

/// What ends a stop is the drives' time, of which the module that was left out says nothing.
TEST(LostModule, IsNotNamedWhereDrivesDoNotSwitchOff) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = kNoLink6;
  run.step(300);
  run.cell.on_send = [](int bus, CanFrame& frame) {
    if (bus == 1 && frame.id == 0x202 && frame.data[0] == 0x02) frame.data[0] = 0x07;
    return true;
  };
  run.cell.input.stop_requested = true;
  ASSERT_TRUE(run.cell.runUntil(Mode::kFault, 10'000));
  EXPECT_EQ(run.fault(), Fault::kDriveStateLost);
  EXPECT_EQ(run.cell.cycle.report().joint, 4);
  EXPECT_EQ(run.cell.cycle.report().detail.module, -1);
  EXPECT_STREQ(run.cell.cycle.report().detail.unit, "");
}

/// It goes back to where the one that counts was last felt, not to where a lost one was.
TEST(LostModule, DoesNotLengthenTheWayBack) {
  SkinRun run(skinScene("go_on_slowly"));
  run.cell.on_frame = kNoLink3;
  run.step(2000);
  run.cell.on_frame = [](int bus, CanFrame& frame) {
    kNoLink3(bus, frame);
    kNoLink4(bus, frame);
    kNoLink6(bus, frame);
  };
  while (run.records.size() < 9000 && run.mode() == Mode::kRunning) run.step(1);
  ASSERT_EQ(run.mode(), Mode::kRetreating);
  const CycleRecord& running = run.records[run.records.size() - 2];
  const Eigen::Map<const Eigen::VectorXd> velocity(running.dq, 9);
  const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(running.q, 9);
  const double speed = velocity.norm();
  run.step(600);
  ASSERT_EQ(run.fault(), Fault::kTactileStale);
  const double way_s = (Eigen::Map<const Eigen::VectorXd>(run.last().q, 9) - q).norm() / speed;
  EXPECT_GT(way_s, 0.03) << "it does go back";
  EXPECT_LT(way_s, 0.1);
}

TEST(LostModule, MayBeLostWhileTheArmHolds) {
  Scene scene = skinScene("go_on_slowly");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  SkinRun run(scene);
  run.cell.on_frame = kNoLink6;
  run.step(300);
  run.cell.switchEnable();
  run.step(300);
  EXPECT_EQ(run.mode(), Mode::kRunning);
  EXPECT_EQ(run.last().modules_lost, kLink6);
  EXPECT_EQ(run.last().speed_share, kShare);
}

}  // namespace
}  // namespace tactus
