#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/record/run_summary.h"

/// What summary and log hold of the modules that an arm went on without.
namespace tactus {
namespace {

Scene lossScene(const std::string& reaction) {
  return test::shippedScene("whole_arm/crops9_skin_two_links",
                            {{"robot.module_lost", reaction}, {"controller.variant", "none"}});
}

/// Losses of each cycle, one bit a module, a cycle a ms.
RunFigures figuresOf(const Scene& scene, const std::vector<std::uint64_t>& lost) {
  RunSummary summary(scene.controller, lost.size());
  CycleRecord record;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    record.t_s = 1e-3 * static_cast<double>(i);
    record.modules_lost = lost[i];
    summary.add(record);
  }
  return summary.figures();
}

TEST(ModuleLosses, AreListedFromWhenToWhen) {
  const Scene scene = lossScene("go_on_slowly");
  std::vector<std::uint64_t> lost(100, 0);
  for (int i = 10; i < 20; ++i) lost[i] |= 4;
  for (int i = 15; i < 40; ++i) lost[i] |= 1;
  for (int i = 90; i < 100; ++i) lost[i] |= 4;
  const Json json = summaryJson(scene, figuresOf(scene, lost), 1.0).at("module_losses");
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0], Json({{"tactile_module", "link6"}, {"start_s", 0.01}, {"end_s", 0.019}}));
  EXPECT_EQ(json[1], Json({{"tactile_module", "link3"}, {"start_s", 0.015}, {"end_s", 0.039}}));
  EXPECT_EQ(json[2], Json({{"tactile_module", "link6"}, {"start_s", 0.09}, {"end_s", 0.099}}));
}

/// However long a run is: what is behind the ten thousandth is counted, and prolongs no other.
TEST(ModuleLosses, AreBounded) {
  const Scene scene = lossScene("go_on_slowly");
  constexpr int kLosses = 10007, kCyclesEach = 4;
  std::vector<std::uint64_t> lost(kLosses * kCyclesEach, 0);
  for (std::size_t i = 0; i < lost.size(); ++i) lost[i] = i % kCyclesEach < 2 ? 1 : 0;
  const RunFigures figures = figuresOf(scene, lost);
  ASSERT_EQ(figures.module_losses.size(), 10000u);
  EXPECT_EQ(figures.further_losses, kLosses - 10000);
  EXPECT_NEAR(figures.module_losses.back().end_s, 1e-3 * (9999 * kCyclesEach + 1), 1e-9);
  const Json json = summaryJson(scene, figures, 1.0);
  EXPECT_EQ(json.at("further_module_losses"), kLosses - 10000);
  EXPECT_FALSE(summaryJson(scene, {}, 1.0).contains("further_module_losses"));
}

TEST(ModuleLosses, AreNothingOfARobotThatStops) {
  const Scene scene = lossScene("stop");
  EXPECT_FALSE(summaryJson(scene, figuresOf(scene, {0, 0}), 1.0).contains("module_losses"));
  EXPECT_FALSE(describeLog(scene).shape.has_loss);
  EXPECT_TRUE(describeLog(lossScene("go_on_slowly")).shape.has_loss);
}

TEST(ModuleLosses, AreReadFromALogAsTheyWereWritten) {
  const Scene scene = lossScene("go_on_slowly");
  const test::TemporaryFile file(".ulg");
  UlogWriter log(file.path(), describeLog(scene));
  CycleRecord record;
  record.modules_lost = 5;
  record.speed_share = 0.375;
  log.write(record);
  log.close();
  std::istringstream in(file.content());
  UlogReader reader(in, "run.ulg");
  EXPECT_EQ(reader.description().shape, describeLog(scene).shape);
  CycleRecord read;
  ASSERT_TRUE(reader.next(read));
  EXPECT_EQ(read.modules_lost, 5u);
  EXPECT_EQ(read.speed_share, 0.375);
}

TEST(ModuleLosses, HaveTheirLinks) {
  EXPECT_EQ(lostModules(lossScene("go_on_slowly"), 6),
            (std::vector<std::string>{"link4", "link6"}));
  EXPECT_TRUE(lostModules(lossScene("go_on_slowly"), 0).empty());
}

}  // namespace
}  // namespace tactus
