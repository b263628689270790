#include "tactus/daemon/path_check.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tactus/daemon/scene_loader.h"

namespace tactus {
namespace {

using Warnings = std::vector<std::string>;

/// The planar arm, whose joints reach 2 rad/s.
Warnings warningsOf(const std::vector<Override>& settings) {
  return checkPath(
      loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/planar2_free.yaml", settings));
}

TEST(PathCheck, HasNothingAgainstTheScenesThatComeAlong) {
  int scenes = 0;
  const std::filesystem::path folder = TACTUS_SOURCE_DIR "/config/scenes";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_EQ(checkPath(loadScene(entry.path().string(), {})), Warnings{}) << entry.path();
    ++scenes;
  }
  EXPECT_GT(scenes, 20);
}

TEST(PathCheck, WarnsOfASpeedBeyondThatOfAJoint) {
  const auto warningsAt = [](const std::string& speed_m_per_s) {
    const std::string line = "task.trajectory.line.";
    return warningsOf({{line + "displacement_m", "[-0.3, 0, 0]"},
                       {line + "speed_m_per_s", speed_m_per_s},
                       {line + "ramp_s", "0.2"}});
  };
  EXPECT_EQ(warningsAt("0.4"), Warnings{});
  const Warnings warnings = warningsAt("0.8");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("; joint elbow is at its largest speed of 2"), std::string::npos)
      << warnings[0];
}

TEST(PathCheck, WarnsOfAStretchedArm) {
  const auto warningsAt = [](const std::string& elbow_rad) {
    return warningsOf({{"start", "[0.6, " + elbow_rad + "]"},
                       {"task.trajectory", "{hold: {}}"},
                       {"task.trajectory.line", "~"}});
  };
  EXPECT_EQ(warningsAt("-1.2"), Warnings{});
  const Warnings stretched = warningsAt("-0.001");
  ASSERT_EQ(stretched.size(), 1u);
  EXPECT_NE(stretched[0].find("singular start: smallest singular value "), std::string::npos)
      << stretched[0];
}

}  // namespace
}  // namespace tactus
