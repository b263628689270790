#include "tactus/daemon/service_watchdog.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "support/notify_socket.h"

namespace tactus {
namespace {

using namespace std::chrono_literals;

constexpr int kWatchdog_us = 4000;
constexpr int kFarTooLong_ms = 60'000;  // for a message that is to come

TEST(LoopHealth, isThatOfALoopThatCountsOn) {
  LoopPulse pulse;
  LoopHealth health(pulse, 3);
  EXPECT_FALSE(health.look());  // no cycle yet
  pulse.cycles = 1;
  EXPECT_TRUE(health.look());
  EXPECT_FALSE(health.look());
  EXPECT_FALSE(health.look());
  pulse.cycles = 500;
  EXPECT_TRUE(health.look());
}

TEST(LoopHealth, isNotThatOfALoopThatMissesCycles) {
  LoopPulse pulse;
  LoopHealth health(pulse, 3);
  const auto lookLate = [&](std::int64_t late_in_a_row) {
    ++pulse.cycles;
    pulse.late_in_a_row = late_in_a_row;
    return health.look();
  };
  EXPECT_TRUE(lookLate(3));  // as many as a scene may allow
  EXPECT_FALSE(lookLate(4));
  EXPECT_TRUE(lookLate(0));  // caught up
}

/// The log's last bytes may wait for a disk; to be started anew for that would move the arm.
TEST(LoopHealth, isThatOfALoopThatHasEnded) {
  LoopPulse pulse;
  LoopHealth health(pulse, 3);
  pulse.cycles = 1;
  pulse.late_in_a_row = 4;  // by an overrun
  EXPECT_FALSE(health.look());
  pulse.has_ended = true;
  EXPECT_TRUE(health.look());
  EXPECT_TRUE(health.look());
}

/// A loop in the hands of the test.
class CountingLoop {
 public:
  explicit CountingLoop(LoopPulse& pulse)
      : thread_([&pulse](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            ++pulse.cycles;
            std::this_thread::sleep_for(100us);
          }
        }) {}

 private:
  std::jthread thread_;
};

TEST(ServiceWatchdog, isFedWhileTheLoopCountsAndStarvesAfterwards) {
  test::NotifySocket manager;
  manager.askForWatchdog(kWatchdog_us);
  LoopPulse pulse;
  const ServiceWatchdog watchdog(pulse, 3);
  {
    const CountingLoop loop(pulse);
    for (int i = 0; i < 5; ++i) ASSERT_EQ(manager.receive(kFarTooLong_ms), "WATCHDOG=1");
  }
  while (!manager.receive().empty()) {
  }
  int late_messages = 0;  // what was counted last may be seen by one more look
  while (late_messages < 3 && !manager.receive(20 * kWatchdog_us / 1000).empty()) ++late_messages;
  EXPECT_LE(late_messages, 1);
  ++pulse.cycles;
  EXPECT_EQ(manager.receive(kFarTooLong_ms), "WATCHDOG=1");
}

TEST(ServiceWatchdog, starvesWhereTheLoopMissesCycles) {
  test::NotifySocket manager;
  manager.askForWatchdog(kWatchdog_us);
  LoopPulse pulse;
  pulse.late_in_a_row = 4;
  const ServiceWatchdog watchdog(pulse, 3);
  const CountingLoop loop(pulse);
  EXPECT_EQ(manager.receive(20 * kWatchdog_us / 1000), "");
  pulse.late_in_a_row = 0;
  EXPECT_EQ(manager.receive(kFarTooLong_ms), "WATCHDOG=1");
}

TEST(ServiceWatchdog, isNotFedUnlessAskedFor) {
  test::NotifySocket manager;
  LoopPulse pulse;
  const ServiceWatchdog watchdog(pulse, 3);
  const CountingLoop loop(pulse);
  EXPECT_EQ(manager.receive(10 * kWatchdog_us / 1000), "");
}

}  // namespace
}  // namespace tactus
