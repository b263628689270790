#include <gtest/gtest.h>

#include "doctor/machine_tree.h"
#include "tactus/doctor/disk_check.h"
#include "tactus/doctor/inspection.h"
#include "tactus/doctor/line_check.h"
#include "tactus/doctor/loop_measurement.h"

namespace tactus {
namespace {

using test::contains;
using test::expectMendable;
using test::levelOf;
using test::MachineTree;

/// A run whose worst cycle woke so late and took so long.
LoopMeasurement measuredWith(std::int64_t latency_ns, std::int64_t step_ns) {
  LoopMeasurement measured;
  measured.period_s = 0.001;
  for (const std::int64_t share : {1, 2}) {
    measured.wake_latency.add(latency_ns * share / 2);
    measured.step.add(step_ns * share / 2);
  }
  measured.cycles = 2;
  return measured;
}

TEST(LoopJudgement, WakingAndStepTogetherHaveABudget) {
  const auto levelAt = [](std::int64_t latency_ns) {
    const auto findings = judgeLoop(measuredWith(latency_ns, 100'000), 200e-6);
    for (const Finding& finding : findings) expectMendable(finding);
    return levelOf(findings, "loop_time");
  };
  EXPECT_EQ(levelAt(99'000), Level::kOk);
  EXPECT_EQ(levelAt(101'000), Level::kWarning);
}

TEST(LoopJudgement, AMissedCycleIsNotFit) {
  LoopMeasurement measured = measuredWith(10, 10);
  measured.missed_cycles = 1;
  const auto findings = judgeLoop(measured, 1.0);
  EXPECT_EQ(levelOf(findings, "loop_time"), Level::kNotFit);
  EXPECT_TRUE(contains(findings[0].what, "1 of 3 cycles missed")) << findings[0].what;
}

TEST(LoopJudgement, PageFaultsAreWarnedOf) {
  LoopMeasurement measured = measuredWith(10, 10);
  EXPECT_EQ(judgeLoop(measured, 1.0).size(), 1u);
  measured.page_faults = 3;
  EXPECT_EQ(levelOf(judgeLoop(measured, 1.0), "page_faults"), Level::kWarning);
}

TEST(LoopMeasurement, RunsTheStepAsOftenAsItSaysAndNamesWhatItGot) {
  int calls = 0;
  const LoopMeasurement measured = measureLoop({}, 0.001, 0.05, [&] { ++calls; });
  EXPECT_EQ(measured.cycles, calls);
  EXPECT_EQ(measured.step.count(), static_cast<std::uint64_t>(calls));
  EXPECT_EQ(measured.wake_latency.count(), static_cast<std::uint64_t>(calls));
  EXPECT_GE(measured.cycles + measured.missed_cycles, 50);
  EXPECT_GE(measured.cycles, 1);
  for (const char* name : {"memory_lock", "cpu_latency", "loop_thread"})
    EXPECT_GE(std::ranges::count(measured.grants, name, &Finding::name), 1) << name;
  for (const Finding& grant : measured.grants) expectMendable(grant);
}

TEST(LoopMeasurement, ACpuThatIsNotThereIsRefusedAsTheDaemonRefusesIt) {
  RealTimeConfig real_time;
  real_time.cpu = 1023;
  const LoopMeasurement measured = measureLoop(real_time, 0.001, 0.005, [] {});
  EXPECT_EQ(std::ranges::count_if(measured.grants,
                                  [](const Finding& f) {
                                    return f.level == Level::kNotFit &&
                                           contains(f.what, "running on CPU 1023 alone");
                                  }),
            1);
}

TEST(DiskCheck, AShiftHasToFitOfALogWithoutLimit) {
  constexpr double kShift_s = 8 * 3600.0;
  const LogNeeds log{.bytes_per_s = 1e5, .reserve_bytes = 1e8};
  const Finding fits = checkDisk("/x", kShift_s * 1e5 + 1e8, log);
  EXPECT_EQ(fits.level, Level::kOk);
  EXPECT_EQ(fits.what,
            "/x: 2980 MB free, 2880 MB of them for a log that grows by 0.10 MB/s without a limit: "
            "8.0 h");
  const Finding finding = checkDisk("/x", kShift_s * 1e5 + 0.99e8, log);
  EXPECT_EQ(finding.level, Level::kWarning) << "it stops with min_free_bytes left";
  expectMendable(finding);
  EXPECT_TRUE(contains(finding.how_to_mend, "8 h, 2980 MB")) << finding.how_to_mend;
  EXPECT_TRUE(contains(checkDisk("/x", 5e7, log).what, "50 MB free, 0 MB of them"));
}

/// Older files go: however long it runs it takes no more.
TEST(DiskCheck, AllFilesThatAreKeptHaveToFitOfALogWithALimit) {
  const LogNeeds log{.bytes_per_s = 6e5, .most_bytes = 5e9, .reserve_bytes = 1e8};
  EXPECT_EQ(checkDisk("/x", 5.1e9, log).level, Level::kOk) << "though a shift is 17 GB";
  const Finding finding = checkDisk("/x", 5.09e9, log);
  EXPECT_EQ(finding.level, Level::kWarning);
  expectMendable(finding);
  EXPECT_TRUE(contains(finding.what, "grows by 0.60 MB/s to at most 5000 MB")) << finding.what;
  EXPECT_TRUE(contains(finding.how_to_mend, "5100 MB")) << finding.how_to_mend;
  const LogNeeds slow{.bytes_per_s = 1e4, .most_bytes = 5e9};
  EXPECT_EQ(checkDisk("/x", 4e9, slow).level, Level::kWarning) << "it runs for more than a shift";
}

TEST(LineCheck, LinesHaveToBeThereAndFree) {
  EXPECT_EQ(checkLines({"", ""}).level, Level::kOk);
  EXPECT_EQ(checkLines({"", "line 4: gpiomon"}).level, Level::kNotFit);
  EXPECT_EQ(checkLines({"", "line 4: tactusd"}).level, Level::kNotFit) << "of another robot";
  EXPECT_EQ(checkLines({"gpiochip0: has no line 9", "line 4: x"}).level, Level::kNotFit);
  for (const GpioSurvey& survey : {GpioSurvey{"", "line 4: x"}, GpioSurvey{"gone", ""}})
    expectMendable(checkLines(survey));
}

TEST(Verdict, WarningsAloneAreFit) {
  EXPECT_TRUE(isFit({}));
  EXPECT_TRUE(
      isFit({{"a", Level::kWarning, "x"}, {"b", Level::kNote, "x"}, {"c", Level::kOk, "x"}}));
  EXPECT_FALSE(isFit({{"a", Level::kOk, "x"}, {"b", Level::kNotFit, "x"}}));
}

TEST(Inspection, LooksAtAllThatARunNeeds) {
  const MachineTree machine;
  MachineNeeds needs;
  needs.log.bytes_per_s = 1.0;
  const auto names = [&] {
    std::vector<std::string> seen;
    for (const Finding& finding : inspectMachine(machine.root(), needs)) {
      expectMendable(finding);
      seen.push_back(finding.name);
    }
    return seen;
  };
  const std::vector<std::string> always = {"kernel",         "rt_throttling",  "rt_group_budget",
                                           "process_rights", "service_rights", "cpu_governor",
                                           "cpu_isolation",  "loop_priority",  "disk"};
  EXPECT_EQ(names(), always);
  needs.buses = {{"nocan0", 1e6}, {"nocan1", 1e6}};
  EXPECT_EQ(names().size(), always.size() + 2);
  needs.gpio.emplace().chip = "no-such-gpiochip";
  EXPECT_EQ(names().size(), always.size() + 3);
  EXPECT_FALSE(isFit(inspectMachine(machine.root(), needs)));
}

TEST(Inspection, SaysThatAFolderForTheLogCannotBeMade) {
  const MachineTree machine;
  machine.write("data/file", "");
  MachineNeeds needs;
  needs.log.bytes_per_s = 1.0;
  const auto disk = [&](const char* folder) {
    needs.log_folder = folder;
    return inspectMachine(machine.root(), needs).back();
  };
  EXPECT_NE(disk("data/new/folder").level, Level::kNotFit) << "it will be made";
  const Finding finding = disk("data/file/folder");
  EXPECT_EQ(finding.level, Level::kNotFit);
  EXPECT_TRUE(contains(finding.what, "data/file/folder: cannot be made")) << finding.what;
  EXPECT_TRUE(contains(finding.what, "data/file is no folder")) << finding.what;
  expectMendable(finding);
}

}  // namespace
}  // namespace tactus
