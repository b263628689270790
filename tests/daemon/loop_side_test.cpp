#include "tactus/daemon/loop_side.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"

namespace tactus {
namespace {

TEST(LoopSide, TellsOfTheLastCycleThatItWasTheLast) {
  const Scene scene = test::shippedScene("scenario1_none");
  test::VirtualRobotCell cell(scene);
  const auto link = std::make_unique<LoopLink>();
  LoopSide side(*link);
  const auto step = [&] {
    cell.step();
    side.finish({}, {}, cell.cycle);
  };
  for (int i = 0; i < 10; ++i) step();
  EXPECT_FALSE(link->pulse.has_ended);
  cell.input.stop_requested = true;
  for (int i = 0; i < 5000 && !cell.cycle.isFinished(); ++i) {
    EXPECT_FALSE(link->pulse.has_ended);
    step();
  }
  EXPECT_TRUE(cell.cycle.isFinished());
  EXPECT_TRUE(link->pulse.has_ended);
}

TEST(LoopSide, TellsOfAModeAsSoonAsThereIsRoom) {
  const Scene scene = test::shippedScene("scenario1_none");
  test::VirtualRobotCell cell(scene);
  const auto link = std::make_unique<LoopLink>();
  LoopSide side(*link);
  while (link->reports.hasRoom(1)) link->reports.push({});
  const auto step = [&] {
    cell.step();
    side.finish({}, {}, cell.cycle);
  };
  const ModeReport before = cell.cycle.report();
  for (int i = 0; i < 5000 && cell.cycle.report().mode != Mode::kRunning; ++i) step();
  ASSERT_NE(cell.cycle.report().mode, before.mode);
  step();
  ModeReport report;
  while (link->reports.pop(report)) EXPECT_NE(report.mode, Mode::kRunning);
  step();
  ASSERT_TRUE(link->reports.pop(report));
  EXPECT_EQ(report.mode, Mode::kRunning);
  EXPECT_FALSE(link->reports.pop(report)) << "and once";
}

TEST(LoopSide, TakesAHoldBeforeAllThatWasOrderedBeforeIt) {
  const Scene scene = test::shippedScene("commands");
  test::VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  const auto link = std::make_unique<LoopLink>();
  LoopSide side(*link);
  ToolSight sight;
  cell.cycle.fill(sight);
  const auto orderOf = [&](std::uint32_t number, ToolOrder::Kind kind) {
    ToolOrder order;
    order.number = number;
    order.run = sight.run;
    order.kind = kind;
    std::copy_n(sight.p_BaseTool_m, 3, order.p_BaseTool_m);
    std::copy_n(sight.R_BaseTool, 9, order.R_BaseTool);
    order.pause_s = 1.0;
    return order;
  };
  const auto newestAfterACycle = [&] {
    cell.step();
    side.finish({}, {}, cell.cycle);
    return cell.cycle.toolReport()->number;
  };
  link->tool_orders.push(orderOf(7, ToolOrder::Kind::kGo));
  for (int i = 1; i < 256; ++i) link->tool_orders.push(orderOf(7, ToolOrder::Kind::kGoNext));
  EXPECT_EQ(newestAfterACycle(), 7U);
  link->tool_holds.put(orderOf(8, ToolOrder::Kind::kHold));
  EXPECT_EQ(newestAfterACycle(), 8U);
  EXPECT_EQ(cell.cycle.toolReport()->state, ToolState::kHolding);
  EXPECT_FALSE(link->tool_orders.front()) << "what it has overtaken is forgotten at once";
  link->tool_orders.push(orderOf(9, ToolOrder::Kind::kGo));
  EXPECT_EQ(newestAfterACycle(), 9U);
  link->tool_holds.put(orderOf(8, ToolOrder::Kind::kHold));
  EXPECT_EQ(newestAfterACycle(), 9U) << "a hold that was seen after what was ordered behind it";
  EXPECT_NE(cell.cycle.toolReport()->state, ToolState::kHolding);
}

}  // namespace
}  // namespace tactus
