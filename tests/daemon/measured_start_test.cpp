#include "tactus/daemon/measured_start.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/shipped_scene.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

TEST(MeasuredStart, PutsAJointBesideItsLimitOnIt) {
  Scene scene = test::shippedScene("commands");
  JointLimits& limits = scene.controller.limits;
  limits.upper[0] = std::numbers::pi / 2;
  const double tolerance = scene.hardware->start_tolerance;
  JointVector q = scene.controller.q_start;
  q[0] = limits.upper[0] + 0.9 * tolerance;
  q[1] = limits.lower[1] - 1.1 * tolerance;
  const JointVector start = startAt(scene, q);
  EXPECT_EQ(start[0], limits.upper[0]);
  EXPECT_EQ(start[1], q[1]) << "is refused as any start beyond limits";
  EXPECT_EQ(start.tail(q.size() - 2), q.tail(q.size() - 2));
}

/// One that is rounded may lie beyond the limit that it was put onto.
TEST(MeasuredStart, IsToldExactly) {
  const Scene scene = test::shippedScene("commands");
  JointVector q = scene.controller.q_start;
  q[1] = -std::numbers::pi / 7;
  q[2] = 1.0 / 3.0;
  const Scene found = test::shippedScene("commands", {{"start", startText(q)}});
  EXPECT_EQ(found.controller.q_start, q);
}

TEST(MeasuredStart, NeedsAnEnableLine) {
  const Override measured{"task.commands.start_measured", "true"};
  EXPECT_FALSE(startsMeasured(test::shippedScene("commands")));
  EXPECT_FALSE(startsMeasured(test::shippedScene("scenario1_tactus")));
  Scene scene = test::shippedScene("commands", {measured});
  EXPECT_TRUE(startsMeasured(scene));
  scene.hardware->gpio.reset();
  try {
    checkMeasuredStart(scene);
    ADD_FAILURE() << "is accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("task.commands.start_measured: no enable line"), std::string::npos) << text;
    EXPECT_NE(text.find("expected gpio.enable"), std::string::npos) << text;
  }
  scene.hardware->gpio.emplace();
  EXPECT_THROW(checkMeasuredStart(scene), InputError);
  scene.hardware->gpio->enable.emplace();
  EXPECT_NO_THROW(checkMeasuredStart(scene));
  EXPECT_NO_THROW(checkMeasuredStart(test::shippedScene("commands")));
}

}  // namespace
}  // namespace tactus
