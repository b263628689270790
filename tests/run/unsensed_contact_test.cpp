#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "support/shipped_scene.h"
#include "tactus/record/run_summary.h"
#include "tactus/run/simulation.h"
#include "tactus/run/touch_check.h"

/// An obstacle in the way of a link that has no module: seen by check and by simulate.
namespace tactus {
namespace {

const std::string kCapsules =
    "[{link: link5, from_m: [0, 0, 0], to_m: [0.12, 0, 0], radius_m: 0.05}]";

/// A ball so far from the end of the fifth link at the start, in the direction of the path.
std::vector<Override> ballAhead(double gap_m) {
  const Scene scene = test::shippedScene("scenario1_none");
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  const Vector3 p = pointInBase(pose, 4, Vector3(0.12, 0.0, 0.0));
  const std::string place = std::to_string(p.x()) + ", " + std::to_string(p.y() + 0.06 + gap_m) +
                            ", " + std::to_string(p.z());
  return {{"robot.collision_capsules", kCapsules},
          {"simulation.duration_s", "6"},
          {"simulation.obstacles",
           "[{x_m: -5, y_m: 0, stiffness_N_per_m: 60}, "
           "{sphere: {center_m: [" +
               place + "], radius_m: 0.01}, stiffness_N_per_m: 1000}]"}};
}

std::vector<std::string> unsensedWarnings(const Scene& scene) {
  std::vector<std::string> warnings = checkContacts(scene, 7000.0).warnings;
  std::erase_if(warnings, [](const std::string& warning) {
    return warning.find("unsensed") == std::string::npos;
  });
  return warnings;
}

SimulationResult run(const Scene& scene) {
  return simulate(scene, [](const CycleRecord&) {});
}

TEST(UnsensedContact, IsWarnedOfWithItsTimeAndForce) {
  const Scene scene = test::shippedScene("scenario1_none", ballAhead(0.05));
  const std::vector<std::string> warnings = unsensedWarnings(scene);
  ASSERT_EQ(warnings.size(), 1u);
  double t_s = 0.0;
  double force_N = 0.0;
  ASSERT_EQ(
      std::sscanf(warnings[0].c_str(),
                  "link5 touches obstacle 1 unsensed at t = %lf s, about %lf N", &t_s, &force_N),
      2)
      << warnings[0];
  const SimulationResult result = run(scene);
  ASSERT_TRUE(result.figures.unsensed);
  const UnsensedContact& met = *result.figures.unsensed;
  EXPECT_GT(met.force_N, 10.0);
  EXPECT_NEAR(force_N, met.force_N, 0.05 * met.force_N) << "nothing gives way in either";
  EXPECT_EQ(met.obstacle, 1);
  EXPECT_GT(met.t_s, t_s - 0.02);
  EXPECT_EQ(result.figures.peak_force_N, 0.0);
  const Json json = summaryJson(scene, result.figures, 1.0);
  EXPECT_EQ(json["unsensed_contact"]["link"], "link5");
  EXPECT_EQ(json["unsensed_contact"]["force_N"], met.force_N);
}

TEST(UnsensedContact, IsWarnedOfAtTheStartWithItsDepth) {
  const std::vector<std::string> warnings =
      unsensedWarnings(test::shippedScene("scenario1_none", ballAhead(-0.012)));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("link5 touches obstacle 1 unsensed at the start, "), 0u)
      << warnings[0];
  EXPECT_NE(warnings[0].find(" mm deep, about "), std::string::npos);
}

TEST(UnsensedContact, IsSaidToBeNoneWhereThereIsNone) {
  std::vector<Override> settings = ballAhead(0.05);
  settings.back().value = "[]";
  const Scene scene = test::shippedScene("scenario1_none", settings);
  EXPECT_TRUE(unsensedWarnings(scene).empty());
  const SimulationResult result = run(scene);
  const Json json = summaryJson(scene, result.figures, 1.0);
  EXPECT_EQ(json["unsensed_contact"]["force_N"], 0.0);
  EXPECT_TRUE(json["unsensed_contact"]["link"].is_null());
}

TEST(UnsensedContact, IsNotKnownOfARobotWithoutCapsules) {
  std::vector<Override> settings = ballAhead(0.05);
  settings.erase(settings.begin());
  const Scene scene = test::shippedScene("scenario1_none", settings);
  EXPECT_TRUE(unsensedWarnings(scene).empty());
  const SimulationResult result = run(scene);
  EXPECT_FALSE(result.figures.unsensed);
  EXPECT_FALSE(summaryJson(scene, result.figures, 1.0).contains("unsensed_contact"));
}

}  // namespace
}  // namespace tactus
