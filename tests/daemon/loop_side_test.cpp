#include "tactus/daemon/loop_side.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tactus
