#include "tactus/bench/several_grid.h"

#include <gtest/gtest.h>

#include "tactus/bench/base_scene.h"
#include "tactus/bench/parallel.h"

namespace tactus {
namespace {

RunSetup skin() {
  const Scene scene = loadScene(
      std::string(TACTUS_SOURCE_DIR) + "/config/scenes/whole_arm/crops9_skin_two_links.yaml", {},
      SceneUse::kSimulation);
  return setupOf(scene);
}

TEST(SeveralGrid, DrawsTheSameEachTimeAndOfAllKinds) {
  const std::vector<SeveralCase> some = drawSeveral(skin(), 5, 24);
  const std::vector<SeveralCase> again = drawSeveral(skin(), 5, 24);
  ASSERT_EQ(some.size(), again.size());
  std::array<int, kDrawnKinds> kinds{};
  for (std::size_t i = 0; i < some.size(); ++i) {
    ++kinds.at(static_cast<std::size_t>(some[i].kind));
    const RunSetup& setup = some[i].setup;
    EXPECT_EQ(setup.plant.obstacles.size(), again[i].setup.plant.obstacles.size());
    EXPECT_EQ(setup.controller.q_start, again[i].setup.controller.q_start);
    EXPECT_EQ(static_cast<int>(setup.plant.obstacles.size()), some[i].modules);
    EXPECT_GE(some[i].modules, 2);
  }
  for (const int of_kind : kinds) EXPECT_GE(of_kind, 2);
}

/// A few of the study's kind: most of them keep to their scale and rest, none is far off.
TEST(SeveralGrid, TheLawKeepsItsForcesAndRests) {
  const std::vector<SeveralCase> cases = drawSeveral(skin(), 77, 30);
  std::vector<SeveralRun> runs(cases.size());
  inParallel(cases.size(), [&](std::size_t i) { runs[i] = runSeveral(cases[i].setup); });
  int judged = 0, with_several = 0, high = 0, restless = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const SeveralRun& run = runs[i];
    if (run.is_out || cases[i].kind == SeveralKind::kMoving) continue;
    SCOPED_TRACE(severalKindName(cases[i].kind) + std::string(" ") + std::to_string(i));
    ++judged;
    with_several += run.touched_modules > 1;
    high += run.largest_peak_to_scale > 1.15;
    restless += !(run.restlessness_N <= JudgedRun::kMaxRestlessness_N);
    EXPECT_EQ(run.fault, Fault::kNone);
    EXPECT_LT(run.largest_peak_to_scale, 1.3);
    EXPECT_LT(run.restlessness_N, 0.2);
    EXPECT_LT(run.peak_at_rest_N, 5.1);
  }
  Table table = emptySeveralTable("several");
  addSeveralRows("alone", cases, runs, table);
  const std::size_t all = table.rows.size() - 1;
  EXPECT_EQ(table.number(all, "runs") + table.number(all, "left_out"),
            static_cast<double>(cases.size()));
  EXPECT_EQ(table.number(all, "faults"), 0.0);
  EXPECT_GE(table.number(all, "left_out"), table.number(all, "left_out_restless"));
  EXPECT_LE(high, 1);
  EXPECT_LE(restless, 1);
  EXPECT_GT(judged, 8);
  EXPECT_GT(with_several, 4);
}

RunSetup skinBetweenBodies() {
  const Scene scene =
      loadScene(std::string(TACTUS_SOURCE_DIR) + "/config/scenes/whole_arm/crops9_skin_rail.yaml",
                {}, SceneUse::kSimulation);
  return setupOf(scene);
}

/// Drives would hear a command that goes to and fro each cycle.
TEST(SeveralGrid, CommandsDoNotStepWhereRowsComeAndGo) {
  const std::vector<SeveralCase> cases = drawSeveral(skinBetweenBodies(), 78, 72);
  std::vector<SeveralRun> runs(cases.size());
  inParallel(cases.size(), [&](std::size_t i) { runs[i] = runSeveral(cases[i].setup); });
  int judged = 0, steps = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    judged += !runs[i].is_out;
    steps += !runs[i].is_out && runs[i].step_between_samples > 0.02;
  }
  EXPECT_GT(judged, 30);
  EXPECT_LE(steps, judged / 20) << "of " << judged;
}

/// The judge sees what it is there for.
TEST(SeveralGrid, TellsAnArmThatDoesNotAnswer) {
  const std::vector<SeveralCase> cases = drawSeveral(skin(), 77, 30);
  int high = 0;
  for (const SeveralCase& one : cases) {
    if (one.kind != SeveralKind::kAtOnce || high > 0) continue;
    RunSetup deaf = one.setup;
    deaf.controller.force_control.reset();
    const SeveralRun run = runSeveral(deaf);
    high += !run.is_out && run.largest_peak_to_scale > 1.15;
  }
  EXPECT_GT(high, 0);
}

}  // namespace
}  // namespace tactus
