#include "tactus/daemon/log_sink.h"

#include <gtest/gtest.h>

#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"

namespace tactus {
namespace {

TEST(LogSink, LogsFromTheFirstCycleOfMotionOn) {
  const test::RunFolder folder;
  LogSink sink(test::shippedScene("scenario1_null_space"), folder.path());
  LoopRecord record;
  record.cycle.t_s = 7.0;
  sink.add(record);
  record.is_in_motion = true;
  record.cycle.t_s = 0.001;
  sink.add(record);
  sink.flush();
  const auto flushed = test::readLog(folder.content("run.ulg"));
  ASSERT_EQ(flushed.records.size(), 1u);
  EXPECT_EQ(flushed.records[0].t_s, 0.001);
  sink.finish({});
  sink.add(record);
  EXPECT_EQ(test::readLog(folder.content("run.ulg")).records.size(), 1u) << "it is closed";
  EXPECT_EQ(sink.state().stop_reason, "");
}

}  // namespace
}  // namespace tactus
