#include "tactus/doctor/kernel_checks.h"

#include <gtest/gtest.h>

#include "doctor/machine_tree.h"

namespace tactus {
namespace {

using test::contains;
using test::expectMendable;
using test::MachineTree;

TEST(KernelChecks, PreemptRtIsFitByEitherSign) {
  const MachineTree machine;
  machine.write("proc/sys/kernel/osrelease", "6.1.0-rt\n");
  machine.write("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian\n");
  const Finding without = checkPreemption(machine.root());
  EXPECT_EQ(without.level, Level::kNotFit);
  expectMendable(without);
  machine.write("sys/kernel/realtime", "1\n");
  EXPECT_EQ(checkPreemption(machine.root()).level, Level::kOk);
  machine.write("sys/kernel/realtime", "0\n");
  EXPECT_EQ(checkPreemption(machine.root()).level, Level::kNotFit);
  machine.write("proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian\n");
  const Finding with = checkPreemption(machine.root());
  EXPECT_EQ(with.level, Level::kOk);
  EXPECT_EQ(with.what, "6.1.0-rt, PREEMPT_RT");
  expectMendable(with);
}

TEST(KernelChecks, ThrottlingIsJudgedByWhatItLeaves) {
  const MachineTree machine;
  EXPECT_EQ(checkThrottling(machine.root()).level, Level::kNote) << "files are missing";
  machine.write("proc/sys/kernel/sched_rt_period_us", "1000000\n");
  const auto levelAt = [&](const char* runtime_us) {
    machine.write("proc/sys/kernel/sched_rt_runtime_us", runtime_us);
    const Finding finding = checkThrottling(machine.root());
    expectMendable(finding);
    return finding.level;
  };
  EXPECT_EQ(levelAt("-1\n"), Level::kOk);
  EXPECT_EQ(levelAt("1000000\n"), Level::kOk);
  EXPECT_EQ(levelAt("950000\n"), Level::kWarning);
  EXPECT_TRUE(contains(checkThrottling(machine.root()).why_it_matters, "for 50 ms"));
  EXPECT_EQ(levelAt("0\n"), Level::kNotFit);
  EXPECT_EQ(levelAt("much\n"), Level::kNote);
}

TEST(KernelChecks, FromLinux612OnAFairServerTakesTheThrottlingsPlace) {
  const MachineTree machine;
  machine.write("proc/sys/kernel/sched_rt_period_us", "1000000\n");
  machine.write("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  const auto levelOf = [&](const char* release) {
    machine.write("proc/sys/kernel/osrelease", release);
    return checkThrottling(machine.root()).level;
  };
  for (const char* release : {"6.1.0-25-rt-amd64\n", "6.11.10\n", "5.19.0\n", "much\n"})
    EXPECT_EQ(levelOf(release), Level::kWarning) << release;
  for (const char* release : {"6.12.0-rt\n", "6.18-rc1\n", "7.0.0\n"})
    EXPECT_EQ(levelOf(release), Level::kNote) << release;
  machine.write("proc/sys/kernel/sched_rt_runtime_us", "0\n");
  EXPECT_EQ(levelOf("6.12.0\n"), Level::kNotFit);
}

TEST(KernelChecks, GroupOfVersion1IsJudgedByItsOwnBudget) {
  const MachineTree machine;
  machine.write("proc/self/cgroup", "4:memory:/a\n3:cpu,cpuacct:/a/b\n0::/x\n");
  EXPECT_EQ(checkControlGroup(machine.root()).level, Level::kOk) << "no such file";
  const std::string budget = "sys/fs/cgroup/cpu,cpuacct/a/b/cpu.rt_runtime_us";
  machine.write(budget, "0\n");
  const Finding trap = checkControlGroup(machine.root());
  EXPECT_EQ(trap.level, Level::kNotFit);
  EXPECT_TRUE(contains(trap.how_to_mend, budget));
  expectMendable(trap);
  machine.write(budget, "950000\n");
  EXPECT_EQ(checkControlGroup(machine.root()).level, Level::kOk);
}

TEST(KernelChecks, GroupOfVersion2IsJudgedByControllerAndKernel) {
  const MachineTree machine;
  machine.write("proc/sys/kernel/osrelease", "6.1.0\n");
  machine.write("proc/self/cgroup", "0::/system.slice/x.service\n");
  const char* const config = "boot/config-6.1.0";
  EXPECT_EQ(checkControlGroup(machine.root()).level, Level::kOk) << "no cpu controller";
  machine.write("sys/fs/cgroup/system.slice/x.service/cpu.max", "max 100000\n");
  EXPECT_EQ(checkControlGroup(machine.root()).level, Level::kNote) << "the kernel does not tell";
  machine.write(config, "CONFIG_SMP=y\n# CONFIG_RT_GROUP_SCHED is not set\n");
  EXPECT_EQ(checkControlGroup(machine.root()).level, Level::kOk);
  machine.write(config, "CONFIG_SMP=y\nCONFIG_RT_GROUP_SCHED=y\n");
  const Finding trap = checkControlGroup(machine.root());
  EXPECT_EQ(trap.level, Level::kNotFit);
  EXPECT_TRUE(contains(trap.how_to_mend, "CPUQuota="));
  expectMendable(trap);
}

TEST(KernelChecks, TellsARealTimeGroupKernelFromOthersAndFromSilence) {
  const MachineTree machine;
  EXPECT_EQ(hasRealTimeGroups(machine.root()), std::nullopt);
  machine.write("proc/sys/kernel/osrelease", "6.1.0\n");
  machine.write("boot/config-6.1.0", "A=y\nCONFIG_RT_GROUP_SCHED_DEFAULT_DISABLED=y\n");
  EXPECT_EQ(hasRealTimeGroups(machine.root()), false);
  machine.write("sys/fs/cgroup/cpu/cpu.rt_runtime_us", "950000\n");
  EXPECT_EQ(hasRealTimeGroups(machine.root()), true);
}

/// As the mend says; a kernel that does not know the parameter takes no notice of it.
TEST(KernelChecks, RealTimeGroupsMayBeSwitchedOffAtBoot) {
  const MachineTree machine;
  machine.write("proc/sys/kernel/osrelease", "6.18.0\n");
  const std::string name = "CONFIG_RT_GROUP_SCHED_DEFAULT_DISABLED";
  const auto hasGroups = [&](const std::string& by_default, const std::string& parameters) {
    machine.write("boot/config-6.18.0", "A=y\nCONFIG_RT_GROUP_SCHED=y\n" + by_default + "\n");
    machine.write("proc/cmdline", "quiet " + parameters + "\n");
    return hasRealTimeGroups(machine.root());
  };
  const std::string is_on = "# " + name + " is not set", is_off = name + "=y";
  EXPECT_EQ(hasGroups(is_on, ""), true);
  EXPECT_EQ(hasGroups(is_off, ""), false);
  EXPECT_EQ(hasGroups(is_on, "rt_group_sched=0"), false);
  EXPECT_EQ(hasGroups(is_off, "rt_group_sched=1"), true);
  EXPECT_EQ(hasGroups("", "rt_group_sched=0"), true);
}

}  // namespace
}  // namespace tactus
