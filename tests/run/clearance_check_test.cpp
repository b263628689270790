#include "tactus/run/clearance_check.h"

#include <gtest/gtest.h>

#include "support/scene_files.h"
#include "tactus/scene/urdf_capsules.h"

namespace tactus {
namespace {

/// What is proposed for a robot, and what touches by it.
std::string proposedFor(const test::SceneFiles& files) {
  const Scene scene = files.load();
  const std::string proposed = proposeCapsules(scene);
  return proposed + touchingCapsules(scene, proposed);
}

TEST(ProposedCapsules, OfMeshesAloneAreNamedAndNone) {
  test::SceneFiles files;
  files.urdf = test::replaced(files.urdf, "<link name=\"cover\"/>",
                              "<link name=\"cover\"><collision><geometry><mesh filename=\"c.stl\"/>"
                              "</geometry></collision></link>");
  EXPECT_TRUE(proposedFor(files).ends_with(
      "collision_capsules:\n  # cover: a mesh, of which no capsule is made: measure it\n"));
}

TEST(ProposedCapsules, TakeThePlaceOfAnEmptyList) {
  const std::string proposed = proposedFor(test::SceneFiles{});
  EXPECT_NE(proposed.find("  - {link: "), std::string::npos);
  for (const char* const none : {"collision_capsules: []\n", "collision_capsules: ~\n"}) {
    test::SceneFiles files;
    files.robot += none;
    EXPECT_EQ(proposedFor(files), proposed) << none;
  }
}

}  // namespace
}  // namespace tactus
