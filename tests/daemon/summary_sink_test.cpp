#include "tactus/daemon/summary_sink.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_folder.h"
#include "support/shipped_scene.h"

namespace tactus {
namespace {

TEST(SummarySink, TellsOfTheMotionTheTimesOfAllCyclesAndTheFault) {
  const test::RunFolder folder;
  const Scene scene = test::shippedScene("scenario1_null_space");
  const LogState log;
  SummarySink sink(scene, folder.path(), log);
  LoopRecord record;
  record.cycle.force_sensor_N[0] = 99.0;
  record.cycle.wake_latency_ns = 5000;
  sink.add(record);
  record.is_in_motion = true;
  record.cycle.force_sensor_N[0] = 2.5;
  record.cycle.wake_latency_ns = 1000;
  sink.add(record);
  sink.flush();
  EXPECT_FALSE(folder.has("summary.json")) << "not before the end";
  RunEnd end;
  end.fault.fault = Fault::kOverrun;
  end.fault.time_s = 1.5;
  end.fault.detail = {4.0, 3.0, "cycles"};
  end.loop.cycles = 2;
  sink.finish(end);
  const Json json = Json::parse(folder.content("summary.json"));
  EXPECT_EQ(json.at("cycles"), 1);
  EXPECT_EQ(json.at("peak_force_N"), 2.5) << "before the motion nothing counts";
  EXPECT_EQ(json.at("loop").at("cycles"), 2);
  EXPECT_EQ(json.at("loop").at("wake_latency_ns").at("max"), 5000) << "but for the times";
  EXPECT_EQ(json.at("log").at("state"), "complete");
  EXPECT_EQ(json.at("outcome"), "overrun");
  EXPECT_EQ(json.at("fault").at("time_s"), 1.5);
  EXPECT_EQ(json.at("fault").at("value"), 4.0);
  EXPECT_EQ(json.at("fault").at("limit"), 3.0);
}

}  // namespace
}  // namespace tactus
