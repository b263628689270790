#include <gtest/gtest.h>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/run/simulation.h"

/// Obstacles of all shapes and capsules, in simulation and on buses.
namespace tactus {
namespace {

TEST(UnsensedOnBuses, IsThatOfTheSimulation) {
  const Scene scene = test::shippedScene(
      "scenario1_none",
      {{"robot.collision_capsules",
        "[{link: link5, from_m: [0, 0, 0], to_m: [0.12, 0, 0], radius_m: 0.05}]"},
       {"simulation.duration_s", "6"},
       {"simulation.obstacles",
        "[{plane: {point_m: [0, 0.05, 0], normal: [0, -1, 0]}, stiffness_N_per_m: 300},"
        " {post: {foot_m: [0.6, 0, 0.5], height_m: 1, radius_m: 0.02}, stiffness_N_per_m: 100}]"}});
  const RunFigures expected = simulate(scene, [](const CycleRecord&) {}).figures;
  ASSERT_TRUE(expected.unsensed);
  ASSERT_GT(expected.unsensed->force_N, 5.0);
  test::VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 6000; ++i) cell.step();
  ASSERT_NE(cell.plant.world().linkContacts(), nullptr);
  const UnsensedContact& met = cell.plant.world().linkContacts()->largest();
  EXPECT_NEAR(met.force_N, expected.unsensed->force_N, 0.01 * expected.unsensed->force_N);
  EXPECT_EQ(met.obstacle, expected.unsensed->obstacle);
}

}  // namespace
}  // namespace tactus
