#include "tactus/bench/drawn_environments.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/crops9.h"
#include "tactus/bench/base_scene.h"
#include "tactus/bench/post_placing.h"

namespace tactus {
namespace {

RunSetup crops9() {
  return {test::crops9Controller(Variant::kNullTask, true), test::crops9Plant(test::scenario2())};
}

RunSetup iiwa() {
  const Scene scene =
      loadScene(std::string(TACTUS_SOURCE_DIR) + "/config/scenes/robots/kuka_iiwa7_contact.yaml",
                {}, SceneUse::kSimulation);
  return setupOf(scene);
}

TEST(DrawnEnvironments, AreTheSameEachTimeAndWithinLimits) {
  const std::vector<RunSetup> some = drawEnvironments(crops9(), 3, 12);
  const std::vector<RunSetup> again = drawEnvironments(crops9(), 3, 12);
  ASSERT_EQ(some.size(), again.size());
  ASSERT_GT(some.size(), 4u);
  EXPECT_LE(some.size(), 12u);
  for (std::size_t i = 0; i < some.size(); ++i) {
    const ControllerConfig& controller = some[i].controller;
    EXPECT_EQ(controller.q_start, again[i].controller.q_start);
    EXPECT_EQ(some[i].plant.obstacles.back().x_m, again[i].plant.obstacles.back().x_m);
    EXPECT_TRUE((controller.q_start.array() >= controller.limits.lower.array()).all());
    EXPECT_TRUE((controller.q_start.array() <= controller.limits.upper.array()).all());
    const bool is_alike = i > 0 && controller.q_start == some[i - 1].controller.q_start;
    EXPECT_FALSE(is_alike);
  }
}

TEST(DrawnEnvironments, SeesAPostThatTouchesAtTheStart) {
  std::vector<RunSetup> some = drawEnvironments(crops9(), 3, 12);
  const auto inside = std::ranges::find_if(some, [](auto& s) { return !runDrawn(s).is_out; });
  ASSERT_NE(inside, some.end());
  RunSetup setup = *inside;
  ChainPose pose;
  setup.controller.chain.computePose(setup.controller.q_start, pose);
  const TactileModuleConfig& module = setup.controller.tactile_modules.front();
  const Pose X = framePose(pose, module.link);
  const Vector3 middle = X.p_AB + 0.5 * module.length_m * X.R_AB.col(0);
  setup.plant.obstacles.back().x_m = middle.x() + 0.01;
  setup.plant.obstacles.back().y_m = middle.y();
  setup.duration_s = 0.01;
  EXPECT_TRUE(runDrawn(setup).is_out);
  for (ObstacleConfig& post : setup.plant.obstacles) post.appears_s = 0.005;
  EXPECT_FALSE(EndWatch(setup).isOut(setup.controller.q_start, 0.0)) << "it is not there yet";
  EXPECT_FALSE(EndWatch(setup).isOut(setup.controller.q_start, 0.01)) << "nor at an end";
}

/// With V that fades below F_th, and c that is forgotten there, about one in seven of the iiwa's
/// swung for ever.
TEST(DrawnEnvironments, TheLawComesToRest) {
  Table table = emptyDrawnTable();
  addDrawnRow("crops9", drawEnvironments(crops9(), 71, 60), table);
  addDrawnRow("iiwa", drawEnvironments(iiwa(), 71, 60), table);
  for (std::size_t row = 0; row < 2; ++row) {
    EXPECT_GT(table.number(row, "runs"), 20.0);
    EXPECT_LE(table.number(row, "limit_cycles"), row == 0 ? 1.0 : 0.0);
    EXPECT_LE(table.number(row, "peaks_above_1_15"), 0.06 * table.number(row, "runs"));
    EXPECT_LT(table.number(row, "limit_cycles"),
              table.number(row, "without_estimator_limit_cycles"));
  }
}

}  // namespace
}  // namespace tactus
