#include <gtest/gtest.h>

#include <algorithm>

#include "support/shipped_scene.h"
#include "tactus/run/contact_report.h"
#include "tactus/run/touch_check.h"
#include "tactus/scene/stability_check.h"

/// What `tactus check` says of an arm with several modules: of each, or of the worst by its name.
namespace tactus {
namespace {

/// With a law: checks ask for its loops, whether or not it can run with several modules.
Scene skinWithLaw(const std::vector<Override>& more = {}) {
  std::vector<Override> settings{{"controller.variant", "none"}};
  settings.insert(settings.end(), more.begin(), more.end());
  Scene scene = test::shippedScene("whole_arm/crops9_skin_in_turn", settings);
  scene.controller.force_control.emplace();
  scene.controller.force_control->variant = Variant::kNullLimit;
  return scene;
}

Scene withOneModule(Scene scene, int module) {
  scene.controller.tactile_modules = {scene.controller.tactile_modules[module]};
  scene.plant.modules = {scene.plant.modules[module]};
  scene.hardware->tactile_modules = {scene.hardware->tactile_modules[module]};
  scene.module_links = {scene.module_links[module]};
  return scene;
}

TEST(SeveralModulesCheck, TellsBothEndsOfEachCover) {
  const std::vector<CoverReport> covers = coversAtStart(skinWithLaw());
  ASSERT_EQ(covers.size(), 3u);
  const double lengths_m[] = {0.22, 0.38, 0.17};
  const char* const links[] = {"link3", "link4", "link6"};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(covers[i].link, links[i]);
    EXPECT_NEAR((covers[i].ends.p_BaseEnd - covers[i].ends.p_BaseStart).norm(), lengths_m[i],
                1e-12);
  }
}

TEST(SeveralModulesCheck, NamesTheLinkOfEachTouch) {
  const Scene scene = skinWithLaw();
  const ExpectedContact expected = checkContacts(scene, 7000.0);
  ASSERT_EQ(expected.touches.size(), 3u);
  const int modules[] = {2, 1, 0};  // as the scene says
  for (int i = 0; i < 3; ++i) EXPECT_EQ(expected.touches[i].touch.module, modules[i]);
  const std::string text = contactText(scene, expected);
  for (const char* const touch : {"0 on link6 at", "1 on link4 at", "2 on link3 at"})
    EXPECT_NE(text.find(touch), std::string::npos) << text;
}

/// The slowest of the covers, with the weakest cells.
TEST(SeveralModulesCheck, HasThePeakOfTheModuleThatBearsLeast) {
  EXPECT_EQ(checkContacts(skinWithLaw(), 7000.0).peak->fastest.module, 2);
  const Scene scene = skinWithLaw({{"robot.tactile_modules[0].max_force_N", "6"}});
  const ExpectedContact expected = checkContacts(scene, 7000.0);
  ASSERT_TRUE(expected.peak);
  EXPECT_EQ(expected.peak->fastest.module, 0);
  EXPECT_EQ(expected.peak->sensor_N, 6.0);
  EXPECT_TRUE(std::ranges::any_of(expected.warnings, [](const std::string& warning) {
    return warning.find("the stiffest contact of link3 may come to") == 0;
  }));
}

TEST(SeveralModulesCheck, HasTheMarginsOfTheLeastStableModule) {
  for (int slowest = 0; slowest < 3; ++slowest) {
    const std::string key =
        "robot.tactile_modules[" + std::to_string(slowest) + "].filter_cutoff_hz";
    const Scene scene = skinWithLaw({{key, "13"}});
    const StabilityReport report = checkStability(scene).value();
    EXPECT_EQ(report.module, slowest);
    const Scene alone = withOneModule(scene, slowest);  // by itself it has the same
    const StabilityReport of_one = checkStability(alone).value();
    EXPECT_EQ(report.loops[0].margins.largest_stiffness_ratio,
              of_one.loops.back().margins.largest_stiffness_ratio);
  }
}

double smallestPhase_deg(const StabilityReport& report) {
  return std::ranges::min(report.loops, {}, &LoopReport::phaseMargin_deg).phaseMargin_deg();
}

/// A filter takes from the ratio what a late sample takes from the phase.
TEST(SeveralModulesCheck, HasTheSmallestPhaseMarginOfAll) {
  int others = 0;
  for (const char* const cutoff_hz : {"10", "14"}) {
    for (const char* const period_s : {"0.004", "0.03", "0.04"}) {
      const Scene scene = skinWithLaw({{"robot.tactile_modules[0].filter_cutoff_hz", cutoff_hz},
                                       {"robot.tactile_modules[2].filter_cutoff_hz", "60"},
                                       {"robot.tactile_modules[2].max_sample_age_s", "0.1"},
                                       {"robot.tactile_modules[2].sample_period_s", period_s},
                                       {"controller.time_constant_s", "0.3"}});
      const StabilityReport report = checkStability(scene).value();
      double least_deg = 180.0;
      for (int i = 0; i < 3; ++i) {
        const Scene alone = withOneModule(scene, i);
        const LoopReport of_one = checkStability(alone).value().loops.back();  // of one space
        least_deg = std::min(least_deg, of_one.phaseMargin_deg());
      }
      EXPECT_EQ(phaseMargin_deg(scene), least_deg) << cutoff_hz << " Hz, " << period_s << " s";
      if (report.module_of_nearest == report.module) continue;
      ++others;
      EXPECT_GT(smallestPhase_deg(report), least_deg);
      EXPECT_NO_THROW(requirePhaseMargin(scene, least_deg));
      EXPECT_THROW(requirePhaseMargin(scene, least_deg + 1e-6), InputError);
    }
  }
  EXPECT_GT(others, 0) << "this test is blind";
}

TEST(SeveralModulesCheck, HasTheSmallestRatioWithGearsOfAll) {
  const Scene scene =
      test::shippedScene("whole_arm/crops9_skin_in_turn",
                         {{"controller.variant", "none"}, {"simulation.arm", "flexible_gears"}});
  Scene with_law = scene;
  with_law.controller.force_control.emplace();
  with_law.controller.force_control->variant = Variant::kNullLimit;
  StabilityReport report = checkStability(with_law).value();
  addGearMargins(with_law, report);
  double smallest = 1e9;
  int whose = -1;
  for (int i = 0; i < 3; ++i) {
    const Scene alone = withOneModule(with_law, i);
    StabilityReport of_one = checkStability(alone).value();
    addGearMargins(alone, of_one);
    ASSERT_TRUE(of_one.loops.back().ratio_with_gears);
    if (*of_one.loops.back().ratio_with_gears >= smallest) continue;
    smallest = *of_one.loops.back().ratio_with_gears;
    whose = i;
  }
  EXPECT_EQ(*report.loops[0].ratio_with_gears, smallest);
  EXPECT_EQ(report.loops[0].module_with_gears, whose);
}

}  // namespace
}  // namespace tactus
