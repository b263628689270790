#include "tactus/doctor/interrupt_checks.h"

#include <gtest/gtest.h>

#include "doctor/machine_tree.h"

namespace tactus {
namespace {

using test::contains;
using test::expectMendable;
using test::MachineTree;

constexpr int kLoop = 80;

/// can0 on a PCI device behind which /proc/interrupts may or may not name it.
class InterruptChecks : public testing::Test {
 protected:
  InterruptChecks() {
    machine.makeFolder(kDevice);
    machine.link("sys/class/net/can0/device", kDevice);
    setTable("can0");
    addThread(12, "irq/33-eth0", 50);
  }

  void setTable(const std::string& name) const {
    machine.write("proc/interrupts",
                  "      CPU0  CPU1\n 33:  1  2  IO-APIC 5-edge  eth0\n 34:  0  7"
                  "  PCI-MSI 9-fasteoi  ahci, " +
                      name + "\nLOC: 3 4 Local can0\n");
  }

  void addThread(int process_id, const std::string& name, int priority) const {
    const std::string folder = "proc/" + std::to_string(process_id);
    machine.write(folder + "/comm", name + "\n");
    std::string stat = std::to_string(process_id) + " (" + name + " )x) S";
    for (int field = 4; field < 40; ++field) stat += " 1";
    machine.write(folder + "/stat", stat + " " + std::to_string(priority) + " 1 0\n");
  }

  Finding only() const {
    const std::vector<Finding> findings = checkInterrupts(machine.root(), "can0", kLoop);
    EXPECT_EQ(findings.size(), 1u);
    if (findings.empty()) return {};
    expectMendable(findings[0]);
    return findings[0];
  }

  static constexpr const char* kDevice = "sys/devices/pci0/0000:03:00.0/usb1";
  MachineTree machine;
};

TEST_F(InterruptChecks, ThreadBetweenOthersAndLoopIsInOrder) {
  addThread(88, "irq/34-can0", 79);
  EXPECT_EQ(only().level, Level::kOk);
  EXPECT_EQ(only().what, "can0: interrupt thread irq/34-can0 has priority 79, the loop 80");
}

TEST_F(InterruptChecks, ThreadAmongAllOthersOrAboveTheLoopIsWarnedOf) {
  for (const int priority : {0, 50, 80, 99}) {
    addThread(88, "irq/34-can0", priority);
    EXPECT_EQ(only().level, Level::kWarning) << priority;
    EXPECT_TRUE(contains(only().how_to_mend, "chrt -f -p 79 88"));
  }
}

TEST_F(InterruptChecks, HardInterruptsGoBeforeAllThreads) {
  EXPECT_EQ(only().level, Level::kOk);
  EXPECT_TRUE(contains(only().what, "34 has no thread")) << only().what;
}

TEST_F(InterruptChecks, OnPreemptRtAThreadThatIsNotFoundSaysNothing) {
  machine.write("sys/kernel/realtime", "1\n");
  EXPECT_EQ(only().level, Level::kNote);
  EXPECT_TRUE(contains(only().what, "thread of interrupt 34 was not found")) << only().what;
}

TEST_F(InterruptChecks, DriversThatNameItOtherwiseAreFoundByTheDevice) {
  setTable("peak_pciefd");
  EXPECT_EQ(only().level, Level::kNote) << "by nothing";
  machine.write("sys/devices/pci0/0000:03:00.0/irq", "34\n");
  addThread(88, "irq/34-peak_pci", 50);
  EXPECT_EQ(only().level, Level::kWarning) << "by its line";
  machine.write("sys/devices/pci0/0000:03:00.0/msi_irqs/35", "msi\n");
  EXPECT_EQ(only().level, Level::kOk) << "messages take the line's place";
  addThread(89, "irq/35-peak_pci", 50);
  EXPECT_EQ(only().level, Level::kWarning);
}

TEST_F(InterruptChecks, EveryThreadIsJudged) {
  addThread(88, "irq/34-can0", 79);
  addThread(89, "irq/34-s-can0", 50);
  const auto findings = checkInterrupts(machine.root(), "can0", kLoop);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].level, Level::kOk);
  EXPECT_EQ(findings[1].level, Level::kWarning);
}

TEST_F(InterruptChecks, AnInterfaceWithoutHardwareHasNone) {
  EXPECT_TRUE(checkInterrupts(machine.root(), "can1", kLoop).empty());
}

TEST_F(InterruptChecks, LoopHasToGoBeforeInterruptThreads) {
  EXPECT_EQ(checkLoopPriority(80).level, Level::kOk);
  EXPECT_EQ(checkLoopPriority(52).level, Level::kOk);
  for (const int priority : {51, 50, 1}) {
    EXPECT_EQ(checkLoopPriority(priority).level, Level::kWarning) << priority;
    expectMendable(checkLoopPriority(priority));
  }
}

}  // namespace
}  // namespace tactus
