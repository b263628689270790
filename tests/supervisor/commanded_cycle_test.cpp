#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/replay.h"

/// The daemon's cycle with a tool that is told where to go, against the plant.
namespace tactus {
namespace {

using test::VirtualRobotCell;

Scene toldScene(std::vector<Override> overrides = {}) {
  Scene scene = test::shippedScene("commands", overrides);
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  return scene;
}

Pose toolPose(const VirtualRobotCell& cell, const Scene& scene) {
  const CycleRecord record = cell.record();
  return tipPose(scene.controller.chain,
                 Eigen::Map<const Eigen::VectorXd>(record.q, scene.controller.chain.size()));
}

ToolOrder orderOf(const Pose& to, std::uint32_t number) {
  ToolOrder order;
  order.number = number;
  order.kind = ToolOrder::Kind::kGo;
  std::copy_n(to.p_AB.data(), 3, order.p_BaseTool_m);
  std::copy_n(to.R_AB.data(), 9, order.R_BaseTool);
  return order;
}

void tell(VirtualRobotCell& cell, const Pose& to, std::uint32_t number,
          ToolOrder::Kind kind = ToolOrder::Kind::kGo) {
  ToolOrder order = orderOf(to, number);
  order.kind = kind;
  ToolSight sight;
  cell.cycle.fill(sight);
  order.run = sight.run;
  cell.cycle.order(order);
}

/// As the loop does it.
void stepPrepared(VirtualRobotCell& cell) {
  cell.step();
  cell.cycle.prepare();
}

TEST(CommandedCycle, LeadsTheToolToItsTarget) {
  const Scene scene = toldScene({{"simulation.obstacles", "[]"}});
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 500; ++i) stepPrepared(cell);
  Pose target = toolPose(cell, scene);
  target.p_AB += Vector3(0.02, 0.1, -0.03);
  tell(cell, target, 1);
  for (int i = 0; i < 3000; ++i) stepPrepared(cell);
  EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kArrived);
  EXPECT_LT((toolPose(cell, scene).p_AB - target.p_AB).norm(), 1e-3);
}

/// How far three components of the task lag behind, from the first on, at most until the tool says
/// that it is there.
double farthestUntilThere(VirtualRobotCell& cell, int first) {
  const auto isThere = [&] { return cell.cycle.toolReport()->state == ToolState::kArrived; };
  double farthest = 0.0;
  for (int i = 0; i < 20000 && !isThere(); ++i) {
    stepPrepared(cell);
    const CycleRecord record = cell.record();
    farthest = std::max(farthest, (Eigen::Map<const Vector3>(record.wd + first) -
                                   Eigen::Map<const Vector3>(record.w + first))
                                      .norm());
  }
  EXPECT_TRUE(isThere());
  return farthest;
}

/// In each direction: joints that are too slow for what was ordered make the tool late.
TEST(CommandedCycle, ArrivesNoFartherOffThanItSays) {
  Scene scene = toldScene({{"simulation.obstacles", "[]"}});
  scene.controller.limits.max_velocity.setConstant(0.05);
  scene.controller.gains.task.drift_gain_per_s = 1.0;
  const double near_m = scene.controller.task.commands->arrival_m;
  for (int axis = 0; axis < 3; ++axis) {
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    Pose target = toolPose(cell, scene);
    target.p_AB += 0.03 * Vector3::Unit(axis);
    tell(cell, target, 1);
    EXPECT_GT(farthestUntilThere(cell, 0), 2.0 * near_m)
        << "it follows at once: this test is blind";
    EXPECT_LT((toolPose(cell, scene).p_AB - target.p_AB).norm(), 1.01 * near_m) << axis;
  }
}

/// Radians are not measured by what is near enough in metres.
TEST(CommandedCycle, ArrivesTurnedNoFartherOffThanItSays) {
  Scene scene = toldScene({{"simulation.obstacles", "[]"},
                           {"task.components", "[x, y, z, rx, ry, rz]"},
                           {"task.max_return_speed_rad_per_s", "0.2"}});
  scene.controller.limits.max_velocity.setConstant(0.05);
  scene.controller.gains.task.drift_gain_per_s = 1.0;
  scene.controller.task.commands->arrival_m = 1.0;
  const double near_rad = scene.controller.task.commands->arrival_rad;
  for (int axis = 0; axis < 3; ++axis) {
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    Pose target = toolPose(cell, scene);
    target.R_AB = Eigen::AngleAxisd(0.1, Vector3::Unit(axis)).toRotationMatrix() * target.R_AB;
    tell(cell, target, 1);
    EXPECT_GT(farthestUntilThere(cell, 3), 2.0 * near_rad)
        << "it follows at once: this test is blind";
    const Matrix3 left = toolPose(cell, scene).R_AB.transpose() * target.R_AB;
    EXPECT_LT(Eigen::AngleAxisd(left).angle(), 1.01 * near_rad) << axis;
  }
}

/// 20 targets and 50 sets of gains in contact, a hold, an e-stop and missed cycles.
void expectReplay(const Scene& scene) {
  test::Random random(4001);
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  std::vector<CycleRecord> records{cell.record()};
  const Pose start = toolPose(cell, scene);
  std::uint32_t targets = 0, changes = 0;
  double largest_N = 0.0;
  for (int i = 0; i < 22000; ++i) {
    if (i % 1000 == 500 && targets < 20) {
      Pose target = start;
      target.p_AB += Vector3(random.uniform(-0.05, 0.05), random.uniform(0.0, 0.44),
                             random.uniform(-0.05, 0.05));
      ++targets;
      tell(cell, target, targets,
           targets % 5 == 4 ? ToolOrder::Kind::kGoNext : ToolOrder::Kind::kGo);
    }
    if (i % 400 == 100 && changes < 50) {
      GainOrder order{.number = ++changes, .gains = scene.controller.gains};
      order.gains.force.time_constant_s = random.uniform(0.08, 0.15);
      order.gains.task.drift_gain_per_s = random.uniform(3.0, 6.0);
      order.gains.posture.gain_per_s = random.uniform(0.2, 2.0);
      cell.cycle.order(order);
    }
    cell.input.lines.enable = !(i > 6000 && i < 6300);
    cell.input.lines.emergency_stop = i > 9000 && i < 9300;
    const bool is_missed = i == 4567;
    cell.input.missed_cycles = is_missed ? 2 : 0;
    if (is_missed) cell.plant.advance(cell.t_ns += 2'000'000);
    cell.step();
    records.push_back(cell.record());
    cell.cycle.prepare();
    largest_N = std::max(largest_N, records.back().force_sensor_N[0]);
  }
  EXPECT_EQ(targets, 20u);
  EXPECT_EQ(changes, 50u);
  EXPECT_GT(largest_N, 1.0) << "no contact: this test is blind";
  const auto log = test::readLog(test::writeLog(describeLog(scene), records));
  ASSERT_EQ(log.records.size(), records.size());
  const Controller controller(scene.controller);
  Replayer replayer(controller, 9, scene.period_s);
  ReplayComparison comparison({9, 3});
  for (const CycleRecord& record : log.records) comparison.add(record, replayer.replay(record));
  EXPECT_EQ(comparison.differingCycles(), 0)
      << comparison.first()->column << " in cycle " << comparison.first()->cycle;
  // Without what the tool was told it would be another run.
  Replayer deaf(controller, 9, scene.period_s);
  ReplayComparison other({9, 3});
  for (CycleRecord record : log.records) {
    record.tool_motion = log.records.front().tool_motion;
    other.add(record, deaf.replay(record));
  }
  EXPECT_GT(other.differingCycles(), 1000) << "targets make no difference: this test is blind";
}

TEST(CommandedCycle, ReplaysToTheBitFromItsLog) { expectReplay(toldScene()); }

TEST(CommandedCycle, ReplaysToTheBitOnItsWayToAPosture) {
  const Scene scene = toldScene(
      {{"redundancy.posture.positions", "[-0.2, -0.1, 0.1, 0.2, 0.8, 0.5, 1.4, -0.4, 0.2]"},
       {"redundancy.joint_limit_avoidance.active_fraction", "0.2"}});
  ASSERT_TRUE(scene.controller.q_posture);
  expectReplay(scene);
}

/// A stiff post that the null space cannot give way to: the arm leans on it no harder than the law
/// allows, however far it was told to go, and a way back is free.
TEST(CommandedCycle, IsHeldOffAtTheForceOfTheLaw) {
  const Scene scene =
      toldScene({{"simulation.obstacles", "[{x_m: 0.70771, y_m: -0.125, stiffness_N_per_m: 7000}]"},
                 {"task.commands", "{give_up_after_s: 3}"}});
  const ForceGains& gains = scene.controller.gains.force;
  const double rest_N = gains.activation_force_N + gains.contact_threshold_N;
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  const Pose start = toolPose(cell, scene);
  Pose target = start;
  target.p_AB.y() += 0.8;
  tell(cell, target, 1);
  for (int i = 0; i < 3500; ++i) stepPrepared(cell);
  EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kBlocked);
  for (int i = 0; i < 8000; ++i) {
    stepPrepared(cell);
    ASSERT_LT(cell.record().force_sensor_N[0], 1.02 * rest_N) << i;
  }
  EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kGivenUp);
  EXPECT_GT(cell.record().force_sensor_N[0], 0.9 * rest_N) << "nothing holds it off";
  tell(cell, start, 2);
  for (int i = 0; i < 4000; ++i) stepPrepared(cell);
  EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kArrived);
  EXPECT_EQ(cell.record().force_sensor_N[0], 0.0);
}

/// Nothing that was ordered before a stop moves the arm after it.
TEST(CommandedCycle, RestsWhereAStopHasLeftIt) {
  const Scene scene = toldScene({{"simulation.obstacles", "[]"}});
  for (const bool is_emergency : {false, true}) {
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    Pose target = toolPose(cell, scene);
    target.p_AB.y() += 0.3;
    tell(cell, target, 1);
    tell(cell, toolPose(cell, scene), 1, ToolOrder::Kind::kGoNext);
    for (int i = 0; i < 1000; ++i) stepPrepared(cell);
    const auto plan = cell.record().tool_motion.number;
    ToolSight before, after;
    cell.cycle.fill(before);
    (is_emergency ? cell.input.lines.emergency_stop : cell.input.lines.enable) = is_emergency;
    for (int i = 0; i < 1000; ++i) stepPrepared(cell);
    EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kStopped);
    const Vector3 rest = toolPose(cell, scene).p_AB;
    EXPECT_GT((target.p_AB - rest).norm(), 0.1) << "it was stopped under way";
    cell.input.lines.emergency_stop = false;
    if (is_emergency) cell.switchEnable();
    cell.input.lines.enable = true;
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 10000));
    for (int i = 0; i < 3000; ++i) stepPrepared(cell);
    EXPECT_GT(cell.record().tool_motion.number, plan)
        << "a plan that is another has another number";
    EXPECT_LT((toolPose(cell, scene).p_AB - rest).norm(), 1e-3) << is_emergency;
    cell.cycle.fill(after);
    const Eigen::Map<const Matrix3> R(after.R_BaseTool);
    EXPECT_LT((R - Eigen::Map<const Matrix3>(before.R_BaseTool)).norm(), 1e-9);
    EXPECT_GT((R - toolPose(cell, scene).R_AB).norm(), 1e-3)
        << "the task says nothing of how the tool is turned";
    EXPECT_NE(after.run, before.run);
    ToolOrder late = orderOf(target, 2);
    late.run = before.run;
    cell.cycle.order(late);
    for (int i = 0; i < 100; ++i) stepPrepared(cell);
    EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kStopped) << "it was told before the stop";
    EXPECT_LT((toolPose(cell, scene).p_AB - rest).norm(), 1e-3);
    tell(cell, target, 2);
    for (int i = 0; i < 6000; ++i) stepPrepared(cell);
    EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kArrived);
    EXPECT_LT((toolPose(cell, scene).p_AB - target.p_AB).norm(), 2e-3);
  }
}

/// Who tells a tool where to go sees whether it would be heard.
TEST(CommandedCycle, SaysWhetherItRuns) {
  VirtualRobotCell cell(toldScene());
  ToolSight sight;
  cell.cycle.fill(sight);
  EXPECT_FALSE(sight.is_running);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  cell.cycle.fill(sight);
  EXPECT_TRUE(sight.is_running);
  cell.input.lines.enable = false;
  for (int i = 0; i < 10; ++i) cell.step();
  cell.cycle.fill(sight);
  EXPECT_FALSE(sight.is_running);
}

/// Who brings an arm back to where its scene begins sees where it is.
TEST(CommandedCycle, SaysWhereAnArmIsThatHasNotRunYet) {
  Scene scene = toldScene({{"simulation.obstacles", "[]"}});
  VirtualRobotCell cell(scene);
  JointVector q = scene.controller.q_start;
  q[3] += 0.4;
  ControllerConfig elsewhere = scene.controller;
  elsewhere.q_start = q;
  cell.plant = Plant(elsewhere, scene.plant, *scene.hardware, scene.period_s, scene.troubles);
  for (int i = 0; i < 4000; ++i) cell.step();
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
  ToolSight sight;
  cell.cycle.fill(sight);
  EXPECT_NEAR(sight.q[3], q[3], 1e-3);
  const Pose there = tipPose(scene.controller.chain, q);
  EXPECT_LT((Eigen::Map<const Vector3>(sight.p_BaseTool_m) - there.p_AB).norm(), 1e-3);
}

/// And turns it, where its orientation is of the task.
TEST(CommandedCycle, TurnsTheTool) {
  const Scene scene = toldScene({{"simulation.obstacles", "[]"},
                                 {"task.components", "[x, y, z, rx, ry, rz]"},
                                 {"task.max_return_speed_rad_per_s", "0.2"}});
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 500; ++i) stepPrepared(cell);
  Pose target = toolPose(cell, scene);
  target.R_AB = Eigen::AngleAxisd(0.3, Vector3::UnitZ()).toRotationMatrix() * target.R_AB;
  tell(cell, target, 1);
  for (int i = 0; i < 5000; ++i) stepPrepared(cell);
  EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kArrived);
  const Matrix3 left = toolPose(cell, scene).R_AB.transpose() * target.R_AB;
  EXPECT_LT(Eigen::AngleAxisd(left).angle(), 2e-3);
  ToolSight sight;
  cell.cycle.fill(sight);
  EXPECT_LT((Eigen::Map<const Matrix3>(sight.R_BaseTool) - target.R_AB).norm(), 1e-2);
}

/// A stop leaves it turned as it is, and not as it lagged behind.
TEST(CommandedCycle, RestsTurnedAsAStopHasLeftIt) {
  const Scene scene = toldScene({{"simulation.obstacles", "[]"},
                                 {"task.components", "[x, y, z, rx, ry, rz]"},
                                 {"task.max_return_speed_rad_per_s", "0.05"}});
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  Pose target = toolPose(cell, scene);
  target.R_AB = Eigen::AngleAxisd(0.3, Vector3::UnitZ()).toRotationMatrix() * target.R_AB;
  tell(cell, target, 1);
  for (int i = 0; i < 300; ++i) stepPrepared(cell);
  cell.input.lines.enable = false;
  for (int i = 0; i < 100; ++i) stepPrepared(cell);
  const Matrix3 rest = toolPose(cell, scene).R_AB;
  EXPECT_GT((rest - target.R_AB).norm(), 0.05) << "it was stopped under way";
  cell.input.lines.enable = true;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 10));
  for (int i = 0; i < 2000; ++i) stepPrepared(cell);
  EXPECT_LT((toolPose(cell, scene).R_AB - rest).norm(), 1e-6);
}

/// A stream that turns the tool faster than its joints can, about one axis: how far the reference
/// is from the tool where the stream then leads on, or back.
double leftAfterATurn(int axis, bool leads_back) {
  constexpr std::array<const char*, 3> kComponents = {"[x, y, z, rx]", "[x, y, z, ry]",
                                                      "[x, y, z, rz]"};
  Scene scene = toldScene({{"simulation.obstacles", "[]"},
                           {"task.components", kComponents[axis]},
                           {"task.max_return_speed_rad_per_s", "0.2"},
                           {"task.wait_beyond_rad", "0.05"}});
  scene.controller.limits.max_velocity.setConstant(0.02);
  VirtualRobotCell cell(scene);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  const Pose start = toolPose(cell, scene);
  std::uint32_t number = 0;
  const auto turn = [&](double angle_rad) {
    Pose target = start;
    target.R_AB = Eigen::AngleAxisd(angle_rad, Vector3::Unit(axis)).toRotationMatrix() * start.R_AB;
    tell(cell, target, ++number, ToolOrder::Kind::kStream);
    stepPrepared(cell);
  };
  for (int i = 0; i < 1000; ++i) turn(0.3);
  const CycleRecord held_off = cell.record();
  EXPECT_GT(std::abs(held_off.wd[3] - held_off.w[3]), 0.02) << "it does not wait";
  turn(leads_back ? -0.3 : 0.4);
  stepPrepared(cell);
  const CycleRecord record = cell.record();
  return std::abs(record.wd[3] - record.w[3]);
}

TEST(CommandedCycle, AStreamLeadsBackATurnThatIsHeldOffAboutEachAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(leftAfterATurn(axis, false), 0.02) << axis;
    EXPECT_LT(leftAfterATurn(axis, true), 1e-3) << axis;
  }
}

}  // namespace
}  // namespace tactus
