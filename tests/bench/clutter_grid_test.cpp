#include "tactus/bench/clutter_grid.h"

#include <gtest/gtest.h>

#include "tactus/bench/base_scene.h"
#include "tactus/bench/parallel.h"

namespace tactus {
namespace {

RunSetup planarSkin() {
  const Scene scene =
      loadScene(std::string(TACTUS_SOURCE_DIR) + "/config/scenes/whole_arm/planar3_clutter.yaml",
                {}, SceneUse::kSimulation);
  return setupOf(scene);
}

std::vector<ClutterRun> runAll(const std::vector<RunSetup>& setups, ClutterLaw law) {
  std::vector<ClutterRun> runs(setups.size());
  inParallel(setups.size(), [&](std::size_t i) {
    RunSetup setup = setups[i];
    useLaw(law, setup);
    runs[i] = runClutter(setup);
  });
  return runs;
}

TEST(ClutterGrid, DrawsPostsApartAndOffTheGoal) {
  const RunSetup base = planarSkin();
  ChainPose pose;
  base.controller.chain.computePose(base.controller.q_start, pose);
  const Vector3 tip = framePosition(pose, base.controller.chain.tip());
  const std::vector<RunSetup> setups = drawClutter(base, ClutterKind::kSliding, 120, 3, 4);
  const std::vector<RunSetup> again = drawClutter(base, ClutterKind::kSliding, 120, 3, 4);
  ASSERT_EQ(setups.size(), 4u);
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const std::vector<ObstacleConfig>& posts = setups[i].plant.obstacles;
    ASSERT_EQ(posts.size(), 120u);
    const Vector3 goal =
        tip + setups[i].controller.task.trajectory.waypoints.front().displacement_m;
    for (std::size_t a = 0; a < posts.size(); ++a) {
      const Vector3& foot = posts[a].post->foot_m;
      EXPECT_EQ(foot, again[i].plant.obstacles[a].post->foot_m);
      EXPECT_GE((foot - goal).head<2>().norm(), 0.025 - 1e-12);
      EXPECT_TRUE(foot.x() >= 0.2 && foot.x() <= 0.6 && std::abs(foot.y()) <= 0.3);
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GE((foot - posts[b].post->foot_m).norm(), 0.02 - 1e-12);
    }
  }
}

/// Few posts that bend or slide: most goals are reached, and no force is far above the limit.
TEST(ClutterGrid, AnArmThatFeelsReachesThroughWhatGivesWay) {
  for (const ClutterKind kind : {ClutterKind::kSoft, ClutterKind::kSliding}) {
    const std::vector<RunSetup> setups = drawClutter(planarSkin(), kind, 20, 5, 8);
    int reached = 0, touching = 0;
    for (const ClutterRun& run : runAll(setups, ClutterLaw::kNullLimit)) {
      reached += run.isReached();
      touching += run.contact_s > 0.0;
      EXPECT_EQ(run.fault, Fault::kNone);
      EXPECT_LT(run.largest_N, 5.5) << clutterKindName(kind);
    }
    EXPECT_GE(reached, 5) << clutterKindName(kind);
    EXPECT_GE(touching, 5) << clutterKindName(kind);
  }
}

/// The judge sees what it is there for.
TEST(ClutterGrid, TellsAnArmThatFeelsNothing) {
  const std::vector<RunSetup> setups = drawClutter(planarSkin(), ClutterKind::kHard, 80, 6, 4);
  int high = 0;
  for (const ClutterRun& run : runAll(setups, ClutterLaw::kNone)) {
    EXPECT_TRUE(run.isReached());
    high += run.high_s > 0.0 && run.largest_N > 5.25;
  }
  EXPECT_GE(high, 3);
}

/// Posts meet the links whose modules the law does not have: with no law at all just as the others.
TEST(ClutterGrid, LinksWithoutTheirModuleAreTouchedAllTheSame) {
  for (const RunSetup& setup : drawClutter(planarSkin(), ClutterKind::kSoft, 80, 7, 3)) {
    RunSetup with = setup, without = setup;
    useLaw(ClutterLaw::kNullTask, without);
    ASSERT_EQ(without.controller.tactile_modules.size(), 1u);
    with.controller.force_control.reset();
    without.controller.force_control.reset();
    const ClutterRun all = runClutter(with), one = runClutter(without);
    EXPECT_GT(all.contact_s, 1.0);
    EXPECT_NEAR(one.contact_s, all.contact_s, 1e-9);
    EXPECT_NEAR(one.largest_N, all.largest_N, 1e-9);
  }
}

}  // namespace
}  // namespace tactus
