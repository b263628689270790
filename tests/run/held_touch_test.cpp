#include "tactus/run/held_touch.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/closed_loop.h"
#include "support/shipped_scene.h"
#include "tactus/run/touch_check.h"

namespace tactus {
namespace {

constexpr double kArmStiffness_N_per_m = 7000.0;

double simulatedPeak_N(const Scene& scene) {
  test::ClosedLoop loop(scene.controller, scene.plant, scene.period_s);
  double peak_N = 0.0;
  while (loop.time_s() < scene.duration_s) {
    loop.step();
    peak_N = std::max(peak_N, loop.robot().trueForce_N());
  }
  return peak_N;
}

Scene planarTouch(const std::string& components, const std::string& controller) {
  return test::shippedScene(
      "robots/planar2_contact",
      {{"task.components", components},
       {"controller", controller},
       {"simulation.obstacles", "[{x_m: 0.6, y_m: 0.085, stiffness_N_per_m: 2000}]"}});
}

/// With x and y bound two joints have no null space, so that the path presses the arm on.
TEST(HeldTouch, IsAWarningWithTheForceThatThePathComesTo) {
  const Scene scene = planarTouch("[x, y]", "{variant: null_space}");
  const ExpectedContact expected = checkContacts(scene, kArmStiffness_N_per_m);
  ASSERT_EQ(expected.warnings.size(), 1u);
  const std::string& warning = expected.warnings[0];
  const std::string said =
      "null_space moves the cover there by 0.0 mm a rad or m of the joints: no "
      "room to give way, it may come to ";
  const std::size_t at = warning.find(said);
  ASSERT_NE(at, std::string::npos) << warning;
  const double force_N = std::stod(warning.substr(at + said.size()));
  EXPECT_GT(force_N, 10.0 * expected.touches[0].peak_N);
  EXPECT_NEAR(simulatedPeak_N(scene), force_N, 0.02 * force_N);
}

TEST(HeldTouch, IsNoneWhereTheArmGivesWay) {
  for (const Scene& scene : {planarTouch("[x]", "{variant: null_space}"),
                             planarTouch("[x, y]", "{variant: null_limit, activation_force_N: 4}"),
                             planarTouch("[x, y]", "{variant: task_space}")}) {
    const ExpectedContact expected = checkContacts(scene, kArmStiffness_N_per_m);
    EXPECT_TRUE(expected.warnings.empty()) << scene.variant;
    ASSERT_EQ(expected.touches.size(), 1u);
    EXPECT_LT(simulatedPeak_N(scene), 6.0) << scene.variant;
  }
}

}  // namespace
}  // namespace tactus
