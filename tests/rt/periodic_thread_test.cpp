#include "tactus/rt/periodic_thread.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <system_error>

#include "tactus/rt/periodic_timer.h"

// No test asks for real time to be granted, and none asserts how late a cycle is.
namespace tactus {
namespace {

PeriodicThreadConfig quick() {
  PeriodicThreadConfig config;
  config.period_ns = 200'000;
  config.real_time.priority = 10;
  return config;
}

TEST(PeriodicThread, runsCyclesOnTheirGridUntilToldToStop) {
  constexpr std::size_t kCycles = 50;
  std::array<Wake, kCycles> wakes;
  std::size_t cycles = 0;
  PeriodicThread thread(quick(), [&](const Wake& wake) noexcept {
    wakes[cycles++] = wake;
    return cycles < kCycles;
  });
  const std::int64_t start_ns = now_ns();
  thread.start();
  thread.join();
  ASSERT_EQ(cycles, kCycles);
  EXPECT_GE(wakes[0].t_ns, start_ns + 200'000);
  for (std::size_t i = 1; i < kCycles; ++i) {
    EXPECT_EQ(wakes[i].t_ns, wakes[i - 1].t_ns + (1 + wakes[i].skipped) * 200'000);
  }
}

TEST(PeriodicThread, runsNoCycleBeforeItIsStarted) {
  std::atomic<int> cycles{0};
  {
    PeriodicThread thread(quick(), [&](const Wake&) noexcept { return ++cycles < 3; });
    const std::int64_t until_ns = now_ns() + 5'000'000;
    while (now_ns() < until_ns) {
    }
    EXPECT_EQ(cycles, 0);
  }
  EXPECT_EQ(cycles, 0) << "the destructor started it";
}

TEST(PeriodicThread, waitsForTheLastCycleWhenItGoes) {
  std::atomic<int> cycles{0};
  {
    PeriodicThread thread(quick(), [&](const Wake&) noexcept { return ++cycles < 20; });
    thread.start();
  }
  EXPECT_EQ(cycles, 20);
}

TEST(PeriodicThread, joinsOnceHoweverOftenItIsAsked) {
  PeriodicThread thread(quick(), [](const Wake&) noexcept { return false; });
  thread.start();
  thread.start();
  thread.join();
  thread.join();
  thread.start();
}

TEST(PeriodicThread, tellsExactlyWhatWasRefusedBeforeTheFirstCycle) {
  int policy = -1;
  PeriodicThread thread(quick(), [&](const Wake&) noexcept {
    policy = sched_getscheduler(0);
    return false;
  });
  const std::size_t refused = thread.refusals().size();
  thread.start();
  thread.join();
  EXPECT_EQ(refused, policy == SCHED_FIFO ? 0u : 1u);
}

TEST(PeriodicThread, runsWithoutWhatWasRefused) {
  PeriodicThreadConfig config = quick();
  config.real_time = {1000, 1 << 20};
  int cycles = 0;
  PeriodicThread thread(config, [&](const Wake&) noexcept { return ++cycles < 3; });
  EXPECT_EQ(thread.refusals().size(), 2u);
  thread.start();
  thread.join();
  EXPECT_EQ(cycles, 3);
}

TEST(PeriodicThread, itselfMakesNoForbiddenCall) {
  SystemCallFilter filter(kLoopSystemCalls);
  PeriodicThreadConfig config = quick();
  config.filter = &filter;
  int cycles = 0;
  PeriodicThread thread(config, [&](const Wake&) noexcept { return ++cycles < 20; });
  thread.start();
  thread.join();
  EXPECT_EQ(cycles, 20);
  EXPECT_EQ(filter.forbiddenCalls().count, 0u) << systemCallName(filter.forbiddenCalls().first);
}

TEST(PeriodicThread, seesAForbiddenCallInTheNextCycle) {
  SystemCallFilter filter(kLoopSystemCalls);
  PeriodicThreadConfig config = quick();
  config.filter = &filter;
  int cycles = 0;
  PeriodicThread thread(config, [&](const Wake&) noexcept {
    if (filter.forbiddenCalls().count > 0) return false;
    if (++cycles == 5) syscall(SYS_getpid);
    return cycles < 1000;
  });
  thread.start();
  thread.join();
  EXPECT_EQ(cycles, 5);
  EXPECT_EQ(filter.forbiddenCalls().first, SYS_getpid);
}

TEST(PeriodicThread, leavesSignalsToOtherThreads) {
  sigset_t blocked;
  sigemptyset(&blocked);
  PeriodicThread thread(quick(), [&](const Wake&) noexcept {
    pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    return false;
  });
  thread.start();
  thread.join();
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGALRM, SIGCHLD, SIGUSR1}) {
    EXPECT_EQ(sigismember(&blocked, signal), 1) << signal;
  }
  for (const int signal : {SIGSYS, SIGSEGV, SIGBUS, SIGFPE}) {
    EXPECT_EQ(sigismember(&blocked, signal), 0) << signal;
  }
}

/// Touches this much of the stack below the caller.
[[gnu::noinline]] void useStack() noexcept {
  volatile char bytes[512 * 1024];
  for (std::size_t i = 0; i < sizeof bytes; i += 4096) bytes[i] = 1;
}

TEST(PeriodicThread, canUseItsStackWithoutPageFaults) {
  int cycles = 0;
  PeriodicThreadConfig config = quick();
  config.stack_bytes = 2 << 20;
  PeriodicThread thread(config, [&](const Wake&) noexcept {
    useStack();
    return ++cycles < 3;
  });
  thread.start();
  thread.join();
  EXPECT_EQ(cycles, 3);
#ifndef TACTUS_SANITIZED  // whose shadow memory faults
  EXPECT_LT(thread.pageFaults().minor, 8) << "of 128 pages of stack";
#endif
}

TEST(PeriodicThread, refusesAPeriodOrAStackThatIsNone) {
  const auto stop = [](const Wake&) noexcept { return false; };
  PeriodicThreadConfig config = quick();
  config.stack_bytes = 1;
  EXPECT_THROW(PeriodicThread(config, stop), std::system_error);
  config = quick();
  config.period_ns = 0;
  EXPECT_THROW(PeriodicThread(config, stop), std::invalid_argument);
}

}  // namespace
}  // namespace tactus
