#include "tactus/doctor/processor_checks.h"

#include <gtest/gtest.h>

#include "doctor/machine_tree.h"

namespace tactus {
namespace {

using test::contains;
using test::expectMendable;
using test::MachineTree;

const std::string kCpus = "sys/devices/system/cpu/";

TEST(MachineFiles, ReadsSetsOfCpusAndLeavesOutWhatIsNone) {
  EXPECT_EQ(cpuSet("0-2,5"), (std::set<int>{0, 1, 2, 5}));
  EXPECT_EQ(cpuSet("7"), std::set<int>{7});
  EXPECT_TRUE(cpuSet("").empty());
  EXPECT_TRUE(cpuSet("(null)").empty());
  EXPECT_TRUE(cpuSet("3-").empty());
  EXPECT_TRUE(cpuSet("0-99999999999,-3").empty());
  EXPECT_EQ(listOf({3, 1}), "1, 3");
}

TEST(MachineFiles, ReadsANumberOrNone) {
  const MachineTree machine;
  const auto readAs = [&](const char* text) {
    machine.write("number", text);
    return readNumber(machine.root() / "number");
  };
  EXPECT_EQ(readAs(" -1\n"), -1);
  EXPECT_EQ(readAs("12x"), std::nullopt);
  EXPECT_EQ(readAs(""), std::nullopt);
  EXPECT_EQ(readNumber(machine.root() / "gone"), std::nullopt);
  EXPECT_EQ(readNumber(machine.root()), std::nullopt) << "a folder";
}

TEST(ProcessorChecks, GovernorOfTheLoopsCpuAloneCounts) {
  const MachineTree machine;
  machine.write(kCpus + "online", "0-1\n");
  EXPECT_EQ(checkGovernor(machine.root(), -1).level, Level::kOk) << "no governor at all";
  machine.write(kCpus + "cpu0/cpufreq/scaling_governor", "schedutil\n");
  machine.write(kCpus + "cpu1/cpufreq/scaling_governor", "performance\n");
  EXPECT_EQ(checkGovernor(machine.root(), 1).level, Level::kOk);
  for (const int cpu : {0, -1}) {
    const Finding finding = checkGovernor(machine.root(), cpu);
    EXPECT_EQ(finding.level, Level::kWarning) << cpu;
    EXPECT_EQ(finding.what, "CPU 0: frequency governor schedutil");
    expectMendable(finding);
  }
}

TEST(ProcessorChecks, LoopWantsACpuForItselfAndWithoutTick) {
  const MachineTree machine;
  const auto expectWarning = [&](int cpu, const char* what) {
    const Finding finding = checkIsolation(machine.root(), cpu);
    EXPECT_EQ(finding.level, Level::kWarning) << finding.what;
    EXPECT_TRUE(contains(finding.what, what)) << finding.what;
    expectMendable(finding);
  };
  machine.write(kCpus + "isolated", "\n");
  expectWarning(-1, "none is isolated");
  expectWarning(3, "CPU 3 is not isolated");
  machine.write(kCpus + "isolated", "2-3\n");
  machine.write(kCpus + "nohz_full", "(null)\n");
  expectWarning(-1, "isolated CPU 2, 3 unused");
  expectWarning(1, "CPU 1 is not isolated");
  expectWarning(3, "keeps its tick");
  machine.write(kCpus + "nohz_full", "3\n");
  EXPECT_EQ(checkIsolation(machine.root(), 3).level, Level::kOk);
  expectWarning(2, "keeps its tick");
}

}  // namespace
}  // namespace tactus
