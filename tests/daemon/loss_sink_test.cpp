#include "tactus/daemon/loss_sink.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/shipped_scene.h"
#include "tactus/daemon/run_status.h"

namespace tactus {
namespace {

Scene slowScene() {
  return test::shippedScene(
      "whole_arm/crops9_skin_two_links",
      {{"robot.module_lost", "go_on_slowly"}, {"controller.variant", "none"}});
}

LoopRecord lostAt(double t_s, std::uint64_t modules_lost) {
  LoopRecord record;
  record.is_in_motion = true;
  record.cycle.t_s = t_s;
  record.cycle.modules_lost = modules_lost;
  return record;
}

TEST(LossSink, SaysEachLossAndReturnOnce) {
  const Scene scene = slowScene();
  LossSink sink(scene);
  ::testing::internal::CaptureStderr();
  sink.add(lostAt(0.0, 0));
  sink.add(lostAt(1.25, 4));
  sink.add(lostAt(1.251, 4));
  sink.add(lostAt(2.5, 5));
  sink.add(lostAt(3.0, 1));
  sink.add(lostAt(4.0, 0));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "tactusd: tactile module link6 lost at 1.25 s, the arm goes on slowly\n"
            "tactusd: tactile module link3 lost at 2.5 s, the arm goes on slowly\n"
            "tactusd: tactile module link6 is back at 3 s\n"
            "tactusd: tactile module link3 is back at 4 s\n");
}

TEST(LossSink, HasItsLikeInTheStatus) {
  const Scene scene = slowScene();
  RunFigures figures;
  figures.modules_lost = 4;
  const LoopFigures loop;
  const std::string running = "running";
  const Json json =
      statusJson({scene, Mode::kRunning, Fault::kNone, running, {}, loop, &figures}, 1.0);
  EXPECT_EQ(json.at("modules_lost"), Json::array({"link6"}));
  const Json before =
      statusJson({scene, Mode::kBoot, Fault::kNone, running, {}, loop, nullptr}, 1.0);
  EXPECT_EQ(before.at("modules_lost"), Json::array());
  const Scene one = test::shippedScene("scenario1_none");
  const Json other =
      statusJson({one, Mode::kRunning, Fault::kNone, running, {}, loop, &figures}, 1.0);
  EXPECT_FALSE(other.contains("modules_lost"));
}

}  // namespace
}  // namespace tactus
