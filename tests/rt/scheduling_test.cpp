#include "tactus/rt/scheduling.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "support/child_process.h"

namespace tactus {
namespace {

using test::holdsInChild;

struct Seen {
  int policy, priority;
  cpu_set_t cpus;
};

Seen schedulingOfThisThread() {
  Seen seen{sched_getscheduler(0), 0, {}};
  sched_param param{};
  sched_getparam(0, &param);
  seen.priority = param.sched_priority;
  sched_getaffinity(0, sizeof seen.cpus, &seen.cpus);
  return seen;
}

bool hasSameCpus(const Seen& a, const Seen& b) { return CPU_EQUAL(&a.cpus, &b.cpus); }

bool isSame(const Seen& a, const Seen& b) {
  return a.policy == b.policy && a.priority == b.priority && hasSameCpus(a, b);
}

/// What a new thread gets, and how it runs then.
std::pair<RealTimeOutcome, Seen> apply(const RealTimeRequest& request) {
  std::pair<RealTimeOutcome, Seen> result;
  std::thread([&] {
    result.first = applyRealTime(request);
    result.second = schedulingOfThisThread();
  }).join();
  return result;
}

TEST(RealTime, saysGrantedExactlyIfItIs) {
  for (const int priority : {1, 10, 99}) {
    const auto [outcome, seen] = apply({priority, -1});
    const bool is_granted = seen.policy == SCHED_FIFO && seen.priority == priority;
    EXPECT_EQ(outcome.policy_error == 0, is_granted) << priority;
    EXPECT_EQ(outcome.affinity_error, 0);
    EXPECT_TRUE(hasSameCpus(seen, schedulingOfThisThread()));
  }
}

TEST(RealTime, isGrantedWhereTheMachineGrantsIt) {
  bool has_right = false;
  std::thread([&] {
    const sched_param param{10};
    has_right = sched_setscheduler(0, SCHED_FIFO, &param) == 0;
  }).join();
  EXPECT_EQ(apply({10, -1}).first.policy_error == 0, has_right);
}

TEST(RealTime, runsOnEachCpuThatTheProcessMayUse) {
  const Seen here = schedulingOfThisThread();
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET(cpu, &here.cpus)) continue;
    const auto [outcome, seen] = apply({10, cpu});
    EXPECT_EQ(outcome.affinity_error, 0) << cpu;
    EXPECT_TRUE(CPU_COUNT(&seen.cpus) == 1 && CPU_ISSET(cpu, &seen.cpus)) << cpu;
  }
}

TEST(RealTime, refusesCpusThatCannotBe) {
  for (const int cpu : {-2, -1000, CPU_SETSIZE - 1, CPU_SETSIZE, CPU_SETSIZE + 1, 1 << 30}) {
    const auto [outcome, seen] = apply({10, cpu});
    EXPECT_EQ(outcome.affinity_error, EINVAL) << cpu;
    EXPECT_TRUE(hasSameCpus(seen, schedulingOfThisThread()));
  }
}

TEST(RealTime, refusesPrioritiesThatCannotBe) {
  for (const int priority : {0, -1, 100, 1 << 30}) {
    const auto [outcome, seen] = apply({priority, -1});
    EXPECT_EQ(outcome.policy_error, EINVAL) << priority;
    EXPECT_EQ(seen.policy, SCHED_OTHER);
  }
}

TEST(RealTime, leavesOtherThreadsAsTheyAre) {
  const Seen before = schedulingOfThisThread();
  apply({10, sched_getcpu()});
  EXPECT_TRUE(isSame(before, schedulingOfThisThread()));
}

TEST(RealTime, isRefusedWithoutTheRight) {
  EXPECT_TRUE(holdsInChild([] {
    if (!test::setLimit(RLIMIT_RTPRIO, 0) || !test::dropCapabilities()) return false;
    const RealTimeOutcome outcome = applyRealTime({10, -1});
    return outcome.policy_error == EPERM && sched_getscheduler(0) == SCHED_OTHER;
  }));
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void expectComplete(const Refusal& refusal) {
  for (const std::string& text : {refusal.what, refusal.why_it_matters, refusal.how_to_grant}) {
    EXPECT_NE(text, "");
    EXPECT_FALSE(mentions(text, "\n")) << text;
  }
}

TEST(RealTimeRefusals, areNoneIfAllWasGranted) { EXPECT_TRUE(realTimeRefusals({}, {}).empty()); }

TEST(RealTimeRefusals, nameWhatWasAskedAndHowToGrantIt) {
  const auto refusals = realTimeRefusals({77, 3}, {EINVAL, EPERM});
  ASSERT_EQ(refusals.size(), 2u);
  for (const Refusal& refusal : refusals) expectComplete(refusal);
  EXPECT_TRUE(mentions(refusals[0].what, "CPU 3")) << refusals[0].what;
  EXPECT_TRUE(mentions(refusals[1].what, "77: Operation not permitted")) << refusals[1].what;
  EXPECT_TRUE(mentions(refusals[1].how_to_grant, "LimitRTPRIO=77"));
  EXPECT_TRUE(mentions(refusals[1].how_to_grant, "RT_GROUP_SCHED"));
}

TEST(RealTimeRefusals, tellAWrongPriorityFromAMissingRight) {
  const auto refusals = realTimeRefusals({100, -1}, {0, EINVAL});
  ASSERT_EQ(refusals.size(), 1u);
  expectComplete(refusals[0]);
  EXPECT_TRUE(mentions(refusals[0].how_to_grant, "1 to 99"));
}

TEST(RealTimeRefusals, tellWhatWasAcceptedWithoutEffect) {
  const auto refusals = realTimeRefusals({10, 0}, {kNotReadBack, kNotReadBack});
  ASSERT_EQ(refusals.size(), 2u);
  for (const Refusal& refusal : refusals) EXPECT_TRUE(mentions(refusal.what, "not in effect"));
}

std::size_t openFiles() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

TEST(CpuLatencyHold, asksForNoLatencyWhileItLives) {
  const std::string path = ::testing::TempDir() + "cpu_latency_hold_test";
  std::ofstream(path).close();
  const std::size_t before = openFiles();
  {
    const CpuLatencyHold hold(path.c_str());
    EXPECT_FALSE(hold.refusal());
    EXPECT_EQ(openFiles(), before + 1);
  }
  EXPECT_EQ(openFiles(), before);
  std::ifstream in(path, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), std::string(4, '\0'));
  std::remove(path.c_str());
}

TEST(CpuLatencyHold, isRefusedWhereTheDeviceIsMissing) {
  const CpuLatencyHold hold("/nonexistent/cpu_dma_latency");
  ASSERT_TRUE(hold.refusal());
  expectComplete(*hold.refusal());
  EXPECT_TRUE(mentions(hold.refusal()->what, "No such file"));
}

TEST(CpuLatencyHold, isRefusedWhereTheDeviceTakesNothing) {
  const CpuLatencyHold hold("/dev/full");
  ASSERT_TRUE(hold.refusal());
  EXPECT_TRUE(mentions(hold.refusal()->how_to_grant, "udev"));
}

}  // namespace
}  // namespace tactus
