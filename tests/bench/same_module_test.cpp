#include "tactus/bench/same_module.h"

#include <gtest/gtest.h>

#include "support/crops9.h"
#include "tactus/bench/parallel.h"

/// Two posts before one module of an arm with a skin.
namespace tactus {
namespace {

std::vector<SeveralCase> pairs() {
  ControllerConfig controller = test::crops9Controller(Variant::kNullLimit, true);
  PlantConfig plant = test::crops9Plant({});
  const std::pair<int, double> covers[] = {{2, 0.23}, {3, 0.38}, {5, 0.18}};  // joint, length in m
  controller.tactile_modules.assign(3, TactileModuleConfig(controller.tactile_modules.front()));
  plant.modules.resize(3, plant.modules.front());
  for (std::size_t i = 0; i < 3; ++i) {
    controller.tactile_modules[i].link.joint = covers[i].first;
    controller.tactile_modules[i].length_m = covers[i].second;
  }
  return drawSameModule({.controller = controller, .plant = plant}, 7, 40);
}

/// Largest force of a single contact over its scale, of all runs on one side that touch twice.
double worstOnOneSide(const std::vector<SeveralCase>& cases, LimitAt at, int& touched_twice) {
  std::vector<SeveralRun> runs(cases.size());
  inParallel(cases.size(), [&](std::size_t i) {
    if (cases[i].kind != SeveralKind::kSameSide) return;
    RunSetup setup = cases[i].setup;
    setup.controller.force_control->limit_at = at;
    runs[i] = runSeveral(setup);
  });
  double worst = 0.0;
  touched_twice = 0;
  for (const SeveralRun& run : runs) {
    EXPECT_EQ(run.fault, Fault::kNone);
    if (run.is_out || run.touched_posts < 2) continue;
    ++touched_twice;
    worst = std::max(worst, run.contact_peak_to_scale);
    EXPECT_LT(run.restlessness_N, 0.2);
  }
  return worst;
}

TEST(SameModule, DrawsAllKindsTheSameEachTime) {
  const std::vector<SeveralCase> some = pairs(), again = pairs();
  ASSERT_EQ(some.size(), again.size());
  std::array<int, kSeveralKinds> kinds{};
  for (std::size_t i = 0; i < some.size(); ++i) {
    ++kinds[static_cast<std::size_t>(some[i].kind)];
    EXPECT_EQ(some[i].setup.plant.obstacles.size(), 2u);
    EXPECT_EQ(some[i].setup.controller.q_start, again[i].setup.controller.q_start);
  }
  for (std::size_t kind = kDrawnKinds; kind < kSeveralKinds; ++kind) EXPECT_GE(kinds[kind], 2);
}

TEST(SameModule, BothContactsOfOneSideAreHeld) {
  const std::vector<SeveralCase> cases = pairs();
  for (const LimitAt at : {LimitAt::kStiffnessCentre, LimitAt::kModuleEnds}) {
    int touched_twice = 0;
    EXPECT_LT(worstOnOneSide(cases, at, touched_twice), 1.15);
    EXPECT_GT(touched_twice, 4);
  }
}

}  // namespace
}  // namespace tactus
