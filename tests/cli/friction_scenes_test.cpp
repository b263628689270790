#include <gtest/gtest.h>

#include "support/closed_loop.h"
#include "support/shipped_scene.h"

namespace tactus {
namespace {

struct RubbedRun {
  double peak_N = 0.0;
  double rest_N = 0.0;
};

/// The true force in a scene whose obstacles all rub.
RubbedRun rub(const std::string& name, const std::string& arm, double mu, double mu_max) {
  Scene scene = test::shippedScene(name, {{"simulation.arm", arm}});
  for (ObstacleConfig& obstacle : scene.plant.obstacles) obstacle.friction_coefficient = mu;
  scene.controller.force_control->friction_coefficient = mu_max;
  scene.controller.tactile_modules.front().max_force_N = kNoLimit;
  test::ClosedLoop loop(scene.controller, scene.plant, scene.period_s);
  RubbedRun run;
  while (loop.time_s() < scene.duration_s) {
    loop.step();
    run.peak_N = std::max(run.peak_N, loop.robot().trueForce_N());
  }
  run.rest_N = loop.robot().trueForce_N();
  return run;
}

TEST(FrictionScenes, KeepTheForceWhereTheLawWithoutFrictionSlidesOn) {
  for (const char* scene : {"scenario3_tactus", "scenario3_tactus_fast"}) {
    EXPECT_GT(rub(scene, "quasi_static", 0.3, 0.0).rest_N, 10.0) << scene;
    const RubbedRun run = rub(scene, "quasi_static", 0.3, 0.5);
    EXPECT_LT(run.peak_N, 1.05 * 5.0) << scene;
    EXPECT_LT(run.rest_N, 1.05 * 5.0) << scene;
  }
}

TEST(FrictionScenes, KeepItWithMassAndFlexibleGears) {
  for (const char* arm : {"rigid_gears", "flexible_gears"}) {
    const RubbedRun run = rub("scenario3_tactus_fast", arm, 0.3, 0.7);
    EXPECT_LT(run.peak_N, 1.1 * 5.0) << arm;
    EXPECT_LT(run.rest_N, 1.05 * 5.0) << arm;
  }
}

}  // namespace
}  // namespace tactus
