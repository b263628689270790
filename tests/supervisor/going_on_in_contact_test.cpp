#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "support/scene_by_law.h"
#include "support/virtual_robot_cell.h"

/// An arm that rests in contact, is held by the enable line, and goes on: at rest as before.
namespace tactus {
namespace {

using test::kLaws;
using test::sceneByLaw;
using test::VirtualRobotCell;

constexpr int kRestingFrom = 13000;  ///< cycles, after the path's end
// More than before the hold.
constexpr double kJump = 0.1;    ///< rad/s, within 0.1 s; out of balance laws jump by 0.3 and more
constexpr double kLater = 0.3;   ///< rad/s, in the seconds in which what begins anew comes back
constexpr double kMore_N = 1.0;  ///< in all of that

/// Fastest joint in so many cycles, and the largest force.
double fastest(VirtualRobotCell& cell, int cycles, double* force_N = nullptr) {
  double fastest = 0.0;
  for (int i = 0; i < cycles; ++i) {
    cell.step();
    cell.cycle.prepare();
    const CycleRecord record = cell.record();
    for (const double dq : record.dq) fastest = std::max(fastest, std::abs(dq));
    if (force_N) *force_N = std::max(*force_N, record.force_sensor_N[0]);
  }
  return fastest;
}

struct Rested {
  double before, first, later;     ///< fastest joint: of 0.1 s after the hold, of 3 s; rad/s
  double force_before, force_max;  ///< N

  void expectNoJump(const std::string& law) const {
    std::printf("%-24s before %.3f, first %.3f, later %.3f rad/s, %.2f N, later %.2f N\n",
                law.c_str(), before, first, later, force_before, force_max);
    EXPECT_LE(first, before + kJump) << law;
    EXPECT_LE(later, before + kLater) << law;
    EXPECT_LE(force_max, force_before + kMore_N) << law;
  }
};

/// What is ordered in the hold has its time in it.
Rested hold(VirtualRobotCell& cell, const GainOrder* order = nullptr) {
  Rested rested;
  rested.before = fastest(cell, 1000);
  rested.force_before = rested.force_max = cell.record().force_sensor_N[0];
  EXPECT_GT(cell.record().force_sensor_N[0], 0.5) << "not in contact: this test is blind";
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  cell.input.lines.enable = false;
  fastest(cell, 500);
  if (order) cell.cycle.order(*order);
  fastest(cell, 5000);
  EXPECT_EQ(cell.cycle.report().mode, Mode::kHolding);
  cell.switchEnable();
  rested.first = fastest(cell, 100, &rested.force_max);
  rested.later = std::max(rested.first, fastest(cell, 2900, &rested.force_max));
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  return rested;
}

VirtualRobotCell restingCell(const Scene& scene) {
  VirtualRobotCell cell(scene);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  fastest(cell, kRestingFrom);
  return cell;
}

TEST(GoingOnInContact, NoLawJumps) {
  for (const char* const law : kLaws) {
    VirtualRobotCell cell = restingCell(sceneByLaw("scenario1_multi_space", law));
    hold(cell).expectNoJump(law);
  }
}

TEST(GoingOnInContact, NoLawJumpsWithAPosture) {
  for (const char* const law : kLaws) {
    VirtualRobotCell cell = restingCell(sceneByLaw("scenario1_multi_space", law, true));
    hold(cell).expectNoJump(law);
  }
}

/// Of a change of gains the arm sees all of the ramp.
TEST(GoingOnInContact, GainsThatAreSetInAHoldAreNoJump) {
  for (const char* const law : kLaws) {
    const Scene scene = sceneByLaw("scenario1_multi_space", law);
    const VirtualRobotCell resting = restingCell(scene);
    for (const double gain : {0.2, 3.0}) {
      VirtualRobotCell cell = resting;
      GainOrder order{.number = 1, .gains = scene.controller.gains};
      order.gains.joint_limit_avoidance.gain *= gain;
      hold(cell, &order).expectNoJump(law + std::string(" gain ") + std::to_string(gain));
      fastest(cell, 30000);
      EXPECT_TRUE(isSame(cell.record().gains, order.gains)) << law;
    }
  }
}

/// The reference is put where the tool is, which was held off it. The laws of one space press too
/// hard on the way.
TEST(GoingOnInContact, ATaskThatIsGoneIsNoJump) {
  for (const char* const law :
       {"joint_space", "null_task", "null_joint", "null_limit", "null_task/a", "null_limit/a"}) {
    VirtualRobotCell cell(sceneByLaw("commands", law));
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    ToolSight sight;
    cell.cycle.fill(sight);
    ToolOrder order;
    order.number = 1;
    order.run = sight.run;
    order.kind = ToolOrder::Kind::kGo;
    std::copy_n(sight.p_BaseTool_m, 3, order.p_BaseTool_m);
    std::copy_n(sight.R_BaseTool, 9, order.R_BaseTool);
    order.p_BaseTool_m[1] += 0.44;
    cell.cycle.order(order);
    fastest(cell, kRestingFrom);
    hold(cell).expectNoJump(law);
  }
}

}  // namespace
}  // namespace tactus
