#include "tactus/daemon/journal_sink.h"

#include <gtest/gtest.h>

#include "support/notify_socket.h"

namespace tactus {
namespace {

TEST(JournalSink, SaysEachChangeOfModeInALineAndToTheManager) {
  test::NotifySocket manager;
  JournalSink sink;
  ::testing::internal::CaptureStderr();
  sink.add({});
  sink.flush();
  sink.onMode({}, "holding: tactile_invalid, at 3.214 s, 102.5 N, at most 100 N");
  sink.onMode({}, "off");
  sink.finish({});
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "tactusd: holding: tactile_invalid, at 3.214 s, 102.5 N, at most 100 N\n"
            "tactusd: off\n");
  EXPECT_EQ(manager.receive(),
            "STATUS=holding: tactile_invalid, at 3.214 s, 102.5 N, at most 100 N");
}

TEST(JournalSink, SaysOnceWhatToDoAboutAFault) {
  JournalSink sink;
  ModeReport report;
  report.fault = Fault::kBusDown;
  ::testing::internal::CaptureStderr();
  sink.onMode(report, "stopping: bus_down");
  sink.onMode(report, "holding: bus_down");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            std::string("tactusd: stopping: bus_down\ntactusd: what to do: ") +
                faultRow(Fault::kBusDown).remedy + "\ntactusd: holding: bus_down\n");
}

TEST(JournalSink, TellsAManagerThatHungOnceItReadsAgain) {
  test::NotifySocket manager;
  manager.fill();
  JournalSink sink;
  sink.onMode({}, "off");
  sink.flush();
  manager.readAll();
  sink.flush();
  EXPECT_EQ(manager.receive(), "STATUS=off");
}

}  // namespace
}  // namespace tactus
