#include "tactus/doctor/rights_checks.h"

#include <gtest/gtest.h>

#include "doctor/machine_tree.h"

namespace tactus {
namespace {

using test::contains;
using test::expectMendable;
using test::MachineTree;

void giveProcess(const MachineTree& machine, const std::string& capabilities,
                 const std::string& priority, const std::string& locked) {
  machine.write("proc/self/status",
                "Name:\tx\nUid:\t0\t1000\t0\t0\nCapEff:\t" + capabilities + "\n");
  machine.write("proc/self/limits",
                "Limit                     Soft Limit  Hard Limit  Units\n"
                "Max locked memory         " +
                    locked +
                    "  unlimited  bytes\n"
                    "Max realtime priority     " +
                    priority + "  99\n");
}

TEST(ProcessRights, ComeFromLimitsOrCapabilities) {
  const MachineTree machine;
  const auto levelWith = [&](const char* capabilities, const char* priority, const char* locked) {
    giveProcess(machine, capabilities, priority, locked);
    const Finding finding = checkProcessRights(machine.root(), 80);
    expectMendable(finding);
    return finding.level;
  };
  EXPECT_EQ(levelWith("0000000000000000", "80", "unlimited"), Level::kOk);
  EXPECT_EQ(levelWith("0000000000000000", "79", "unlimited"), Level::kNote);
  EXPECT_EQ(levelWith("0000000000000000", "80", "8388608"), Level::kNote);
  EXPECT_EQ(levelWith("0000000000804000", "0", "8388608"), Level::kOk);
  EXPECT_EQ(levelWith("0000000000800000", "0", "8388608"), Level::kNote) << "CAP_SYS_NICE alone";
  EXPECT_EQ(levelWith("0000000000004000", "0", "8388608"), Level::kNote) << "CAP_IPC_LOCK alone";
  EXPECT_TRUE(contains(checkProcessRights(machine.root(), 80).what,
                       "user 1000: RLIMIT_RTPRIO 0, RLIMIT_MEMLOCK 8388608 (CAP_IPC_LOCK)"));
}

const std::string kUnit = "lib/systemd/system/tactusd.service";

Finding service(const MachineTree& machine, const std::string& keys, bool has_groups = false) {
  machine.write(kUnit, "[Unit]\nLimitRTPRIO=99\n[Service]\nUser=tactus\n" + keys);
  const Finding finding = checkServiceRights(machine.root(), 80, has_groups);
  expectMendable(finding);
  return finding;
}

TEST(ServiceRights, AreNotJudgedWithoutAService) {
  const MachineTree machine;
  EXPECT_EQ(checkServiceRights(machine.root(), 80, true).level, Level::kNote);
}

TEST(ServiceRights, AMaskedServiceDoesNotStart) {
  const MachineTree machine;
  machine.write("usr/lib/systemd/system/tactusd.service", "[Service]\nLimitRTPRIO=99\n");
  machine.write("etc/systemd/system/tactusd.service", "");
  const Finding finding = checkServiceRights(machine.root(), 80, false);
  EXPECT_EQ(finding.level, Level::kNotFit);
  EXPECT_EQ(finding.what, "/etc/systemd/system/tactusd.service is masked");
  expectMendable(finding);
}

TEST(ServiceRights, ComeFromTheUnit) {
  const MachineTree machine;
  const std::string both = "LimitRTPRIO=80\nLimitMEMLOCK=infinity\n";
  EXPECT_EQ(service(machine, both).level, Level::kOk);
  EXPECT_EQ(service(machine, "LimitRTPRIO=95:99\nLimitMEMLOCK=infinity").level, Level::kOk);
  EXPECT_EQ(service(machine, "AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK").level, Level::kOk);
  EXPECT_EQ(service(machine, "").what,
            "/" + kUnit + " should say LimitRTPRIO=80, LimitMEMLOCK=infinity");
  EXPECT_EQ(service(machine, "").level, Level::kNotFit);
  EXPECT_EQ(service(machine, both + "#LimitRTPRIO=1\nLimitRTPRIO=79").level, Level::kNotFit);
  EXPECT_TRUE(contains(service(machine, both + "RestrictRealtime=true").what,
                       "should say RestrictRealtime=no"));
}

TEST(ServiceRights, CapabilitiesOfSeveralLinesAddUp) {
  const MachineTree machine;
  const std::string both = "AmbientCapabilities=CAP_SYS_NICE\nAmbientCapabilities=CAP_IPC_LOCK\n";
  EXPECT_EQ(service(machine, both).level, Level::kOk);
  EXPECT_EQ(service(machine, both + "AmbientCapabilities=\n").level, Level::kNotFit);
}

TEST(ServiceRights, LinesGoOnBehindABackslash) {
  const MachineTree machine;
  const auto levelOf = [&](const char* keys) { return service(machine, keys).level; };
  EXPECT_EQ(levelOf("AmbientCapabilities=CAP_SYS_NICE \\\n  CAP_IPC_LOCK\n"), Level::kOk);
  EXPECT_EQ(levelOf("AmbientCapabilities=CAP_SYS_NICE\\\r\nCAP_IPC_LOCK\r\n"), Level::kOk);
  EXPECT_EQ(levelOf("AmbientCapabilities=CAP_SYS_NICE \\\n# why\n ; or\nCAP_IPC_LOCK"), Level::kOk)
      << "comments are no part of it";
  EXPECT_EQ(levelOf("LimitMEMLOCK=infinity\nEnvironment=A=1 \\\nLimitRTPRIO=80\n"), Level::kNotFit)
      << "a part of the environment";
  EXPECT_EQ(levelOf("LimitMEMLOCK=infinity\nEnvironment=A=1 \\\n\nLimitRTPRIO=80\n"), Level::kOk)
      << "an empty line ends it";
  EXPECT_EQ(levelOf("LimitMEMLOCK=infinity\nEnvironment=A=\\\\\nLimitRTPRIO=80\n"), Level::kOk)
      << "two are one that is meant";
  EXPECT_EQ(levelOf("LimitMEMLOCK=infinity\nLimitRTPRIO=80\\"), Level::kOk) << "the last line";
}

TEST(ServiceRights, AreTakenByTheBoundingSet) {
  const MachineTree machine;
  const auto levelOf = [&](const std::string& keys, bool is_root) {
    machine.write(kUnit, "[Service]\n" + std::string(is_root ? "" : "User=tactus\n") + keys);
    return checkServiceRights(machine.root(), 80, false).level;
  };
  const std::string set = "CapabilityBoundingSet=";
  const std::string both = "CAP_SYS_NICE CAP_IPC_LOCK\n";
  EXPECT_EQ(levelOf(set + "\n", true), Level::kNotFit) << "empty: none, also root";
  EXPECT_EQ(levelOf(set + "\nLimitRTPRIO=80\nLimitMEMLOCK=infinity\n", true), Level::kOk);
  EXPECT_EQ(levelOf(set + both, true), Level::kOk);
  EXPECT_EQ(levelOf(set + "CAP_CHOWN\n", true), Level::kNotFit);
  EXPECT_EQ(levelOf(set + "CAP_CHOWN\n" + set + both, true), Level::kOk);
  EXPECT_EQ(levelOf(set + both + set + "\n", true), Level::kNotFit);
  EXPECT_EQ(levelOf(set + "~CAP_CHOWN\n", true), Level::kOk) << "all but that";
  EXPECT_EQ(levelOf(set + "~CAP_SYS_NICE\n", true), Level::kNotFit);
  EXPECT_EQ(levelOf(set + "\n" + set + "~\n", true), Level::kOk) << "all again";
  EXPECT_EQ(levelOf("AmbientCapabilities=" + both, false), Level::kOk);
  EXPECT_EQ(levelOf("AmbientCapabilities=" + both + set + "\n", false), Level::kNotFit);
  EXPECT_EQ(levelOf("AmbientCapabilities=~CAP_CHOWN\n", false), Level::kOk);
  EXPECT_EQ(levelOf("AmbientCapabilities=" + both + "AmbientCapabilities=~CAP_SYS_NICE\n", false),
            Level::kNotFit);
}

TEST(ServiceRights, WithoutAUserAreThoseOfRoot) {
  const MachineTree machine;
  machine.write(kUnit, "[Service]\nExecStart=x\n");
  EXPECT_EQ(checkServiceRights(machine.root(), 80, false).level, Level::kOk);
  machine.write(kUnit, "[Service]\nDynamicUser=yes\n");
  EXPECT_EQ(checkServiceRights(machine.root(), 80, false).level, Level::kNotFit);
}

TEST(ServiceRights, AreThoseOfRootAlsoWhereItIsNamed) {
  const MachineTree machine;
  const auto levelOf = [&](const char* keys) {
    machine.write(kUnit, std::string("[Service]\n") + keys);
    return checkServiceRights(machine.root(), 80, false).level;
  };
  EXPECT_EQ(levelOf("User=root\n"), Level::kOk);
  EXPECT_EQ(levelOf("User=0\n"), Level::kOk);
  EXPECT_EQ(levelOf("User=rooted\n"), Level::kNotFit);
  EXPECT_EQ(levelOf("User=tactus\nUser=root\n"), Level::kOk) << "the last one";
  EXPECT_EQ(levelOf("User=root\nCapabilityBoundingSet=CAP_CHOWN\n"), Level::kNotFit);
}

TEST(ServiceRights, CpuQuotaTakesThemWhereTheKernelHasRealTimeGroups) {
  const MachineTree machine;
  const std::string keys = "LimitRTPRIO=80\nLimitMEMLOCK=infinity\nCPUQuota=50%\n";
  EXPECT_EQ(service(machine, keys, false).level, Level::kOk);
  const Finding trap = service(machine, keys, true);
  EXPECT_EQ(trap.level, Level::kNotFit);
  EXPECT_TRUE(contains(trap.how_to_mend, "systemctl edit tactusd.service")) << trap.how_to_mend;
  EXPECT_TRUE(contains(trap.how_to_mend, "CPUQuota=;")) << trap.how_to_mend;
  machine.write("etc/systemd/system/tactusd.service.d/10-all.conf", "[Service]\nCPUQuota=\n");
  EXPECT_EQ(checkServiceRights(machine.root(), 80, true).level, Level::kOk) << "reset by a drop-in";
}

TEST(ServiceRights, AdministratorsUnitAndTemplatesCount) {
  const MachineTree machine;
  machine.write("usr/lib/systemd/system/tactusd@.service", "[Service]\nUser=tactus\n");
  EXPECT_EQ(checkServiceRights(machine.root(), 80, false).level, Level::kNotFit);
  machine.write("etc/systemd/system/tactusd@.service",
                "[Service]\nUser=tactus\nLimitRTPRIO=infinity\nLimitMEMLOCK=infinity\n");
  EXPECT_EQ(checkServiceRights(machine.root(), 80, false).level, Level::kOk);
}

}  // namespace
}  // namespace tactus
