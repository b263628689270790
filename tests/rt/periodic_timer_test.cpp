#include "tactus/rt/periodic_timer.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/time.h>

#include <atomic>

// Nothing here asserts how late a wake-up is: that is the machine's business.
namespace tactus {
namespace {

TEST(PeriodicTimer, clockNeverRunsBackwards) {
  std::int64_t last_ns = now_ns();
  EXPECT_GT(last_ns, 0);
  for (int i = 0; i < 100'000; ++i) {
    const std::int64_t time_ns = now_ns();
    ASSERT_GE(time_ns, last_ns);
    last_ns = time_ns;
  }
}

TEST(PeriodicTimer, neverWakesEarlyAndKeepsItsPhase) {
  constexpr std::int64_t kPeriod_ns = 500'000;
  const std::int64_t before_ns = now_ns();
  PeriodicTimer timer(kPeriod_ns);
  const Wake first = timer.wait();
  EXPECT_GE(first.t_ns, before_ns + kPeriod_ns);
  std::int64_t last_ns = first.t_ns;
  for (int i = 0; i < 50; ++i) {
    const Wake wake = timer.wait();
    ASSERT_EQ(wake.t_ns, last_ns + (1 + wake.skipped) * kPeriod_ns);
    ASSERT_GE(now_ns(), last_ns + kPeriod_ns + wake.latency_ns);
    last_ns = wake.t_ns;
  }
}

TEST(PeriodicTimer, wakesHalfAPeriodOffWholeOnes) {
  for (const std::int64_t period_ns : {1, 2, 3, 1001, 100'000, 333'333, 1'000'000}) {
    const std::int64_t before_ns = now_ns();
    PeriodicTimer timer(period_ns);
    const std::int64_t after_ns = now_ns();
    const Wake first = timer.wait();
    const std::int64_t due_ns = first.t_ns - first.skipped * period_ns;
    EXPECT_EQ(due_ns % period_ns, period_ns / 2);
    EXPECT_GT(due_ns, before_ns + period_ns);
    EXPECT_LE(due_ns, after_ns + 2 * period_ns);
  }
}

TEST(PeriodicTimer, refusesAPeriodThatIsNone) {
  EXPECT_THROW(PeriodicTimer(0), std::invalid_argument);
  EXPECT_THROW(PeriodicTimer(-1), std::invalid_argument);
}

TEST(PeriodicTimer, skipsWhatALoopThatFellAsleepHasMissed) {
  constexpr std::int64_t kPeriod_ns = 100'000;
  PeriodicTimer timer(kPeriod_ns);
  const std::int64_t busy_until_ns = timer.wait().t_ns + 10 * kPeriod_ns;
  while (now_ns() < busy_until_ns) {
  }
  const Wake wake = timer.wait();
  EXPECT_GE(wake.skipped, 9);
  EXPECT_GE(wake.late_in_a_row, 10);
  EXPECT_GE(wake.latency_ns, 9 * kPeriod_ns);
  EXPECT_GE(wake.t_ns, busy_until_ns);
}

std::atomic<int> alarms{0};

/// Alarms for as long as it lives, many within a period.
class Alarms {
 public:
  Alarms() {
    struct sigaction action {};
    action.sa_handler = [](int) { ++alarms; };
    sigemptyset(&action.sa_mask);
    sigaction(SIGALRM, &action, &old_action_);
    every(300);
  }
  ~Alarms() {
    every(0);
    sigaction(SIGALRM, &old_action_, nullptr);
  }

 private:
  static void every(suseconds_t us) {
    const itimerval interval{{0, us}, {0, us}};
    setitimer(ITIMER_REAL, &interval, nullptr);
  }

  struct sigaction old_action_ {};
};

TEST(PeriodicTimer, sleepsOnAfterASignal) {
  const Alarms ringing;
  PeriodicTimer timer(5'000'000);
  for (int wakes = 0; wakes < 10 || alarms < 100; ++wakes) {
    const Wake wake = timer.wait();
    ASSERT_GE(wake.latency_ns, 0) << "woken before it was due";
    ASSERT_GE(now_ns(), wake.t_ns);
  }
}

}  // namespace
}  // namespace tactus
