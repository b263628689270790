#include "tactus/daemon/status_sink.h"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "support/run_folder.h"
#include "support/shipped_scene.h"

namespace tactus {
namespace {

TEST(StatusSink, ShowsAChangeOfModeAtOnce) {
  const test::RunFolder folder;
  const Scene scene = test::shippedScene("scenario1_null_space");
  const auto link = std::make_unique<LoopLink>();
  {
    StatusSink sink(scene, *link, nullptr);
    sink.flush();
    LoopRecord record;
    record.is_in_motion = true;
    record.cycle.force_sensor_N[0] = 2.5;
    sink.add(record);
    link->pulse.cycles = 17;
    ModeReport report;
    report.mode = Mode::kHolding;
    report.fault = Fault::kTactileInvalid;
    sink.onMode(report, "holding: 102.5 N");
    const Json json = Json::parse(folder.content(kStatusName));
    EXPECT_EQ(json.at("mode"), "holding");
    EXPECT_EQ(json.at("fault"), "tactile_invalid");
    EXPECT_EQ(json.at("description"), "holding: 102.5 N");
    EXPECT_EQ(json.at("cycles"), 17);
    EXPECT_EQ(json.at("motion").at("force_N"), 2.5);
    EXPECT_FALSE(json.contains("log"));
  }
  EXPECT_FALSE(folder.has(kStatusName)) << "a daemon that has ended has none";
}

TEST(StatusSink, TellsWhatTheLogHasComeTo) {
  const test::RunFolder folder;
  const Scene scene = test::shippedScene("scenario1_null_space");
  const auto link = std::make_unique<LoopLink>();
  LogState log;
  StatusSink sink(scene, *link, &log);
  log.stop_reason = "disk full";
  sink.onMode({}, "boot");
  EXPECT_EQ(Json::parse(folder.content(kStatusName)).at("log").at("reason"), "disk full");
}

}  // namespace
}  // namespace tactus
