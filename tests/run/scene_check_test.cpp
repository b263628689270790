#include "tactus/run/scene_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "support/shipped_scene.h"

namespace tactus {
namespace {

/// No end of a ratio is null, as JSON has no infinity; a loop whose gears nobody judged has none.
TEST(SceneCheck, TellsARatioWithoutEndFromNone) {
  const std::string member = "largest_stiffness_ratio_with_gears";
  const Scene scene = test::shippedScene("scenario1_multi_space");
  Findings findings = examine(scene);
  const auto loops = [&] {
    return Json::parse(checkJson(scene, findings)["stability"]["loops"].dump());
  };
  ASSERT_EQ(findings.stability->loops.size(), loops().size());
  EXPECT_FALSE(loops().front().contains(member)) << "of both spaces";
  EXPECT_GT(loops().back().at(member), 0.0);
  findings.stability->loops.back().ratio_with_gears = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(loops().back().at(member).is_null());
}

}  // namespace
}  // namespace tactus
