#include "tactus/record/capture_ring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tactus {
namespace {

constexpr RecordShape kRingShape{.joints = 2, .task_size = 1};
constexpr double kCycle_s = 0.001;

/// Touches of 0.1 s that begin at these times.
CycleRecord cycleAt(int i, const std::vector<double>& touches_s) {
  CycleRecord record;
  record.t_s = kCycle_s * i;
  for (const double touch_s : touches_s)
    if (record.t_s >= touch_s - 1e-9 && record.t_s < touch_s + 0.1) record.force_sensor_N[0] = 5.0;
  record.u_n = i;
  return record;
}

struct CapturedRun {
  std::vector<Capture> captures;
  std::optional<Capture> unfinished;
};

CapturedRun captured(const CaptureWindow& window, const std::vector<double>& touches_s,
                     int cycles) {
  CaptureRing ring(parseTrigger("force_N > 1.2", kRingShape), window);
  CapturedRun run;
  for (int i = 0; i < cycles; ++i)
    if (std::optional<Capture> capture = ring.add(cycleAt(i, touches_s)))
      run.captures.push_back(std::move(*capture));
  run.unfinished = ring.unfinished();
  return run;
}

TEST(CaptureRing, HoldsExactlyWhatIsAroundTheTrigger) {
  const CapturedRun run = captured({.pre_s = 0.3, .post_s = 0.5}, {1.0, 2.5}, 4000);
  ASSERT_EQ(run.captures.size(), 2u);
  EXPECT_FALSE(run.unfinished);
  for (std::size_t n = 0; n < 2; ++n) {
    const Capture& capture = run.captures[n];
    const int trigger = n == 0 ? 1000 : 2500;
    EXPECT_NEAR(capture.trigger_s, kCycle_s * trigger, 1e-12);
    ASSERT_EQ(capture.records.size(), 801u);
    for (int i = 0; i <= 800; ++i)
      ASSERT_EQ(capture.records[static_cast<std::size_t>(i)].u_n, trigger - 300 + i);
  }
}

TEST(CaptureRing, KeepsWhatLedToItApart) {
  const CapturedRun run = captured({.pre_s = 0.3, .post_s = 0.5, .lead_s = 0.6}, {1.0, 2.5}, 4000);
  ASSERT_EQ(run.captures.size(), 2u);
  const Capture& capture = run.captures[1];
  EXPECT_EQ(capture.records.front().u_n, 1600.0);
  EXPECT_EQ(capture.records.back().u_n, 3000.0);
  EXPECT_NEAR(capture.from_s, 2.2, 1e-6);
}

TEST(CaptureRing, HasLessBeforeATriggerAtTheStart) {
  const CapturedRun run = captured({.pre_s = 0.3, .post_s = 0.2}, {0.05}, 1000);
  ASSERT_EQ(run.captures.size(), 1u);
  EXPECT_EQ(run.captures[0].records.size(), 251u);
  EXPECT_EQ(run.captures[0].records.front().u_n, 0.0);
}

TEST(CaptureRing, TakesNoSecondTriggerIntoOneCapture) {
  const CapturedRun run = captured({.pre_s = 0.1, .post_s = 1.0}, {1.0, 1.5, 2.2}, 3000);
  ASSERT_EQ(run.captures.size(), 1u);
  ASSERT_TRUE(run.unfinished);
  EXPECT_NEAR(run.unfinished->trigger_s, 2.2, 1e-12);
  EXPECT_EQ(run.unfinished->records.back().u_n, 2999.0);
}

TEST(CaptureRing, ShowsTheNewestWithoutATrigger) {
  CaptureRing ring(parseTrigger("force_N > 1.2", kRingShape), {.pre_s = 0.2, .post_s = 0.3});
  EXPECT_TRUE(ring.newest().records.empty());
  for (int i = 0; i < 5000; ++i) ring.add(cycleAt(i, {}));
  const Capture newest = ring.newest();
  EXPECT_FALSE(newest.is_triggered);
  EXPECT_EQ(newest.records.size(), 501u);
  EXPECT_EQ(newest.records.back().u_n, 4999.0);
}

/// As of a second run behind the first.
TEST(CaptureRing, BeginsAnewWhereTimeGoesBack) {
  CaptureRing ring(parseTrigger("force_N > 1.2", kRingShape), {.pre_s = 0.3, .post_s = 0.1});
  for (int i = 0; i < 2050; ++i) ring.add(cycleAt(i, {2.0}));
  int captures = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::optional<Capture> capture = ring.add(cycleAt(i, {0.5}));
    if (!capture) continue;
    ++captures;
    EXPECT_NEAR(capture->trigger_s, 0.5, 1e-12);
    EXPECT_EQ(capture->records.size(), 401u);
  }
  EXPECT_EQ(captures, 1);
}

}  // namespace
}  // namespace tactus
