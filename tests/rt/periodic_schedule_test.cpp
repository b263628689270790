#include "tactus/rt/periodic_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

namespace tactus {
namespace {

constexpr std::int64_t kSchedulePeriod_ns = 1000;

/// A loop whose cycles take the time given, on a machine that wakes it exactly.
class Loop {
 public:
  Wake run(std::int64_t duration_ns) {
    const std::int64_t now_ns = std::max(ready_ns_, schedule_.due_ns());
    const Wake wake = schedule_.wake(ready_ns_, now_ns);
    ready_ns_ = now_ns + duration_ns;
    return wake;
  }

 private:
  PeriodicSchedule schedule_{5000, kSchedulePeriod_ns};
  std::int64_t ready_ns_ = 4000;
};

void expectWake(const Wake& wake, const Wake& expected) {
  EXPECT_EQ(wake.t_ns, expected.t_ns);
  EXPECT_EQ(wake.latency_ns, expected.latency_ns);
  EXPECT_EQ(wake.skipped, expected.skipped);
  EXPECT_EQ(wake.late_in_a_row, expected.late_in_a_row);
}

TEST(PeriodicSchedule, runsEachCycleOfALoopThatIsQuickEnough) {
  Loop loop;
  for (int k = 0; k < 5; ++k)
    expectWake(loop.run(kSchedulePeriod_ns), {5000 + k * kSchedulePeriod_ns, 0, 0, 0});
}

TEST(PeriodicSchedule, recoversFromOneSlowCycle) {
  Loop loop;
  expectWake(loop.run(1400), {5000, 0, 0, 0});
  expectWake(loop.run(300), {6000, 400, 0, 1});
  expectWake(loop.run(300), {7000, 0, 0, 0});
}

TEST(PeriodicSchedule, skipsTheCyclesWhosePeriodHasGoneBy) {
  Loop loop;
  expectWake(loop.run(4250), {5000, 0, 0, 0});
  expectWake(loop.run(100), {9000, 3250, 3, 4});
  expectWake(loop.run(100), {10000, 0, 0, 0});
}

TEST(PeriodicSchedule, seesThatALoopIsAlwaysTooSlow) {
  Loop loop;
  expectWake(loop.run(1500), {5000, 0, 0, 0});
  expectWake(loop.run(1500), {6000, 500, 0, 1});
  expectWake(loop.run(1500), {8000, 1000, 1, 3});
  expectWake(loop.run(1500), {9000, 500, 0, 4});
}

TEST(PeriodicSchedule, countsCyclesThatTheMachineSleptThrough) {
  PeriodicSchedule schedule(5000, kSchedulePeriod_ns);
  expectWake(schedule.wake(4000, 5999), {5000, 999, 0, 0});
  expectWake(schedule.wake(6000, 7000), {7000, 1000, 1, 2});  // ready in time, woken a period late
  EXPECT_EQ(schedule.due_ns(), 8000);
}

TEST(PeriodicSchedule, refusesAPeriodThatIsNone) {
  EXPECT_THROW(PeriodicSchedule(0, 0), std::invalid_argument);
  EXPECT_THROW(PeriodicSchedule(0, -1), std::invalid_argument);
}

/// What cycles became of, by looking at one after the other.
struct Account {
  std::int64_t due_ns;
  std::int64_t late_in_a_row = 0;

  Wake wake(std::int64_t period_ns, std::int64_t ready_ns, std::int64_t time_ns) {
    Wake wake;
    bool is_late = ready_ns > due_ns;
    wake.latency_ns = time_ns - due_ns;
    while (due_ns + period_ns <= time_ns) {
      is_late = true;
      ++wake.skipped;
      ++late_in_a_row;
      due_ns += period_ns;
    }
    late_in_a_row = is_late ? late_in_a_row + 1 : 0;
    wake.t_ns = due_ns;
    wake.late_in_a_row = late_in_a_row;
    due_ns += period_ns;
    return wake;
  }
};

TEST(PeriodicSchedule, agreesWithCountingOneByOneForAnyLoop) {
  std::mt19937_64 random(3);
  for (int run = 0; run < 200; ++run) {
    const auto period_ns = static_cast<std::int64_t>(1 + random() % 2'000'000);
    const auto start_ns = static_cast<std::int64_t>(random() % (1ull << 60));
    PeriodicSchedule schedule(start_ns, period_ns);
    Account account{start_ns};
    std::int64_t time_ns = start_ns - period_ns;
    for (int cycle = 0; cycle < 200; ++cycle) {
      const std::uint64_t worst = random() % 8 == 0 ? 9 * period_ns : period_ns;
      const std::int64_t ready_ns = time_ns + static_cast<std::int64_t>(random() % (worst + 1));
      const auto sleep_ns = static_cast<std::int64_t>(random() % worst);
      time_ns = std::max(ready_ns, schedule.due_ns() + (random() % 2 == 0 ? 0 : sleep_ns));
      const Wake expected = account.wake(period_ns, ready_ns, time_ns);
      const Wake wake = schedule.wake(ready_ns, time_ns);
      expectWake(wake, expected);
      ASSERT_FALSE(HasFailure());
      ASSERT_GE(wake.latency_ns, 0);
      ASSERT_EQ(wake.latency_ns / period_ns, wake.skipped) << "later than what it missed, or less";
      ASSERT_EQ((wake.t_ns - start_ns) % period_ns, 0) << "phase lost";
      ASSERT_GT(schedule.due_ns(), time_ns) << "would catch up";
    }
  }
}

TEST(PeriodicSchedule, outlivesAPauseOfYears) {
  PeriodicSchedule schedule(7, 1'000'000);
  const std::int64_t years_ns = 1'000'000'000'000'000'000;
  const Wake wake = schedule.wake(0, years_ns);
  EXPECT_EQ(wake.skipped, 999'999'999'999);
  EXPECT_EQ(wake.t_ns, 7 + 999'999'999'999 * 1'000'000);
  EXPECT_EQ(wake.latency_ns, years_ns - 7);
}

}  // namespace
}  // namespace tactus
