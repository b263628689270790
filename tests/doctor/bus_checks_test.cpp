#include "tactus/doctor/bus_checks.h"

#include <gtest/gtest.h>

#include "doctor/machine_tree.h"

namespace tactus {
namespace {

using test::contains;
using test::expectMendable;
using test::levelOf;
using test::MachineTree;

const BusConfig kBus{"can0", 1e6};
const std::string kNet = "sys/class/net/can0/";

CanLink controller() { return {"can", 1'000'000, 0}; }

/// can0 on a PCI controller, up, with a short queue: all in order.
class BusChecks : public testing::Test {
 protected:
  BusChecks() {
    machine.write(kNet + "type", "280\n");
    machine.write(kNet + "flags", "0x40081\n");
    machine.write(kNet + "tx_queue_len", "10\n");
    putOn("pci");
  }

  void putOn(const std::string& bus) const {
    std::filesystem::remove_all(machine.root() / (kNet + "device"));
    machine.makeFolder("sys/bus/" + bus);
    machine.link(kNet + "device/subsystem", "sys/bus/" + bus);
  }

  std::vector<Finding> check(const std::optional<CanLink>& link = controller()) const {
    const std::vector<Finding> findings = checkBus(machine.root(), kBus, link);
    for (const Finding& finding : findings) {
      expectMendable(finding);
      EXPECT_TRUE(finding.what.starts_with("can0")) << finding.what;
    }
    return findings;
  }

  MachineTree machine;
};

TEST_F(BusChecks, NothingToMendWhereAllIsInOrder) {
  const std::vector<Finding> findings = check();
  EXPECT_EQ(findings.size(), 7u);
  for (const Finding& finding : findings) EXPECT_EQ(finding.level, Level::kOk) << finding.what;
}

TEST_F(BusChecks, AMissingInterfaceIsAllThereIsToSay) {
  std::filesystem::remove_all(machine.root() / "sys");
  const std::vector<Finding> findings = check(std::nullopt);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(levelOf(findings, "can_interface"), Level::kNotFit);
}

TEST_F(BusChecks, AnotherKindOfInterfaceIsNotFit) {
  machine.write(kNet + "type", "1\n");
  const std::vector<Finding> findings = check(std::nullopt);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].what, "can0 is no CAN interface");
}

TEST_F(BusChecks, AnInterfaceThatIsDownIsNotFit) {
  machine.write(kNet + "flags", "0x40080\n");
  const std::vector<Finding> findings = check();
  EXPECT_EQ(levelOf(findings, "can_interface"), Level::kNotFit);
  EXPECT_EQ(findings[0].how_to_mend, "ip link set can0 up type can bitrate 1000000 restart-ms 0");
}

TEST_F(BusChecks, UsbAndSerialLinesAreWarnedOf) {
  putOn("usb");
  EXPECT_EQ(levelOf(check(), "can_adapter"), Level::kWarning);
  std::filesystem::remove_all(machine.root() / (kNet + "device"));
  EXPECT_EQ(levelOf(check(), "can_adapter"), Level::kWarning);
  EXPECT_EQ(levelOf(check(std::nullopt), "can_adapter"), Level::kWarning) << "of older kernels";
}

TEST_F(BusChecks, AVirtualInterfaceIsNotedAndHasNoBitRate) {
  std::filesystem::remove_all(machine.root() / (kNet + "device"));
  const std::vector<Finding> findings = check(CanLink{"vcan", 0, 0});
  EXPECT_EQ(levelOf(findings, "can_adapter"), Level::kNote);
  EXPECT_EQ(findings.size(), 3u);
  machine.write(kNet + "flags", "0x80\n");
  EXPECT_EQ(check(CanLink{"vcan", 0, 0})[0].how_to_mend, "ip link set can0 up");
}

TEST_F(BusChecks, AnotherBitRateThanTheRobotsIsNotFit) {
  const std::vector<Finding> findings = check(CanLink{"can", 500'000, 0});
  EXPECT_EQ(levelOf(findings, "can_bit_rate"), Level::kNotFit);
  EXPECT_EQ(findings[2].what, "can0: 500000 bit/s, but robot.yaml says 1000000");
  EXPECT_TRUE(contains(findings[2].how_to_mend, "ip link set can0 down")) << "set only while down";
  EXPECT_EQ(levelOf(check(CanLink{"can", 0, 0}), "can_bit_rate"), Level::kNotFit);
}

TEST_F(BusChecks, ABusOfCanFdHasARateOfItsData) {
  const BusConfig bus{"can0", 1e6, 5e6};
  const auto findings = [&](long data_bit_rate_per_s) {
    return checkBus(machine.root(), bus, CanLink{"can", 1'000'000, 0, data_bit_rate_per_s});
  };
  EXPECT_EQ(levelOf(findings(5'000'000), "can_data_bit_rate"), Level::kOk);
  const std::vector<Finding> other = findings(0);
  EXPECT_EQ(levelOf(other, "can_data_bit_rate"), Level::kNotFit);
  EXPECT_EQ(other[3].what, "can0: data at 0 bit/s, but robot.yaml says 5000000");
  EXPECT_TRUE(contains(other[3].how_to_mend, "bitrate 1000000 dbitrate 5000000 fd on"));
  EXPECT_EQ(check().size(), 7u) << "a classic bus is not asked for one";
}

/// A data bit rate alone does not let frames of CAN FD through; a virtual interface has none.
TEST_F(BusChecks, AnInterfaceWithoutCanFdIsNotFitWhereRobotHasIt) {
  const BusConfig bus{"can0", 1e6, 5e6};
  for (const bool is_virtual : {false, true}) {
    const CanLink link =
        is_virtual ? CanLink{"vcan", 0, 0} : CanLink{"can", 1'000'000, 0, 5'000'000};
    const auto findings = [&](const std::string& mtu) {
      machine.write(kNet + "mtu", mtu);
      return checkBus(machine.root(), bus, link);
    };
    EXPECT_EQ(levelOf(findings("72\n"), "can_fd"), Level::kOk);
    const std::vector<Finding> classic = findings("16\n");
    EXPECT_EQ(levelOf(classic, "can_fd"), Level::kNotFit);
    const auto& finding = *std::ranges::find(classic, "can_fd", &Finding::name);
    expectMendable(finding);
    EXPECT_TRUE(contains(finding.how_to_mend, is_virtual ? "mtu 72" : "fd on"));
  }
}

TEST_F(BusChecks, AControllerThatIsOffTheBusIsNotFit) {
  CanLink link = controller();
  EXPECT_EQ(levelOf(check(link), "can_state"), Level::kOk);
  link.is_passive = true;
  EXPECT_EQ(levelOf(check(link), "can_state"), Level::kWarning);
  link.is_passive = false;
  link.is_bus_off = true;
  EXPECT_EQ(levelOf(check(link), "can_state"), Level::kNotFit);
}

TEST_F(BusChecks, AModeThatKeepsFramesFromDrivesIsSwitchedOff) {
  struct Mode {
    bool CanLink::*is_on;
    Level level;
    const char* name;
  };
  for (const Mode& mode : {Mode{&CanLink::is_listen_only, Level::kNotFit, "listen-only off"},
                           {&CanLink::is_loopback, Level::kNotFit, "loopback off"},
                           {&CanLink::is_one_shot, Level::kNotFit, "one-shot off"},
                           {&CanLink::presumes_ack, Level::kWarning, "presume-ack off"}}) {
    CanLink link = controller();
    link.*mode.is_on = true;
    const std::vector<Finding> findings = check(link);
    EXPECT_EQ(levelOf(findings, "can_mode"), mode.level) << mode.name;
    const auto& finding = *std::ranges::find(findings, "can_mode", &Finding::name);
    EXPECT_TRUE(finding.how_to_mend.ends_with(mode.name)) << finding.how_to_mend;
  }
}

TEST_F(BusChecks, RestartAfterBusOffIsWarnedOf) {
  EXPECT_EQ(levelOf(check(CanLink{"can", 1'000'000, 100}), "can_restart"), Level::kWarning);
}

TEST_F(BusChecks, ALongQueueIsWarnedOfAsByTheDaemon) {
  machine.write(kNet + "tx_queue_len", "20\n");
  EXPECT_EQ(levelOf(check(), "can_queue"), Level::kOk);
  machine.write(kNet + "tx_queue_len", "21\n");
  EXPECT_EQ(levelOf(check(), "can_queue"), Level::kWarning);
}

}  // namespace
}  // namespace tactus
