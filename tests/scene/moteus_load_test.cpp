#include <gtest/gtest.h>

#include <numbers>

#include "support/hardware_files.h"
#include "tactus/canopen/bus_load.h"

namespace tactus {
namespace {

/// The robot with two buses, whose shoulder and lift are moteus controllers on CAN FD.
test::SceneFiles moteusFiles() {
  test::SceneFiles files = test::hardwareFiles();
  files.robot = test::replaced(files.robot, "{interface: can0}",
                               "{interface: can0, data_bit_rate_per_s: 5e6}");
  files.robot =
      test::replaced(files.robot, "node_id: 2, counts_per_rad: 1e6", "node_id: 2, kind: moteus");
  files.robot = test::replaced(files.robot, "node_id: 1, counts_per_m: 1e7",
                               "node_id: 1, kind: moteus, turns_per_m: 100");
  return files;
}

TEST(MoteusLoad, CountsInTurns) {
  const HardwareConfig hardware = moteusFiles().load().hardware.value();
  EXPECT_EQ(hardware.drives[0].kind, DriveKind::kMoteus);
  EXPECT_EQ(hardware.drives[0].counts_per_unit, 100.0);
  EXPECT_EQ(hardware.drives[0].offset, 0.25);
  EXPECT_EQ(hardware.drives[1].kind, DriveKind::kMoteus);
  EXPECT_DOUBLE_EQ(hardware.drives[1].counts_per_unit * 2.0 * std::numbers::pi, 1.0);
  EXPECT_EQ(hardware.drives[2].kind, DriveKind::kCia402);
}

TEST(MoteusLoad, MayBeKnownByItsRotorAlone) {
  test::SceneFiles files = moteusFiles();
  EXPECT_EQ(files.load().hardware.value().drives[1].home, MoteusHome::kOutput);
  files.robot = test::replaced(files.robot, "node_id: 2, kind: moteus",
                               "node_id: 2, kind: moteus, home: rotor");
  EXPECT_EQ(files.load().hardware.value().drives[1].home, MoteusHome::kRotor);
}

TEST(MoteusLoad, IsInTheLoadOfItsBusWithoutSyncAndHeartbeat) {
  const HardwareConfig hardware = moteusFiles().load().hardware.value();
  const BusLoad load = busLoads(hardware, 0.001)[0];
  ASSERT_EQ(load.terms.size(), 2u);
  const FdBits command = worstCaseFdBits(32, true), reply = worstCaseFdBits(32, true);
  EXPECT_DOUBLE_EQ(load.bitsPerSecond() * 0.001, 2 * (command.arbitration + reply.arbitration) +
                                                     2 * (command.data + reply.data) / 5.0);
  EXPECT_LT(load.share(), kMaxBusLoad);
}

TEST(MoteusLoad, LeavesTheSheetOfAllDrivesToTheOthers) {
  test::SceneFiles files = moteusFiles();
  files.robot = test::replaced(files.robot, "drives:\n", "drives:\n  eds: gone.eds\n");
  const std::string error = test::loadError(files.sources());
  EXPECT_NE(error.find("gone.eds"), std::string::npos) << "roll is a drive of CANopen: " << error;
}

/// They would do nothing, and a trial with them show nothing.
TEST(MoteusLoad, RefusesTroublesThatItDoesNotHave) {
  for (const std::string kind : {"boot_up", "heartbeat_only"}) {
    const auto problem = [&](const std::string& id) {
      test::SceneFiles files = moteusFiles();
      files.scene =
          test::replaced(files.scene, "simulation:\n",
                         "simulation:\n  troubles: [{kind: " + kind +
                             ", from_s: 1, until_s: 2, interface: can0, id: " + id + "}]\n");
      return test::loadError(files.sources());
    };
    EXPECT_NE(problem("1").find(kind + " says nothing to a moteus"), std::string::npos);
    EXPECT_NE(problem("0").find(kind + " says nothing to a moteus"), std::string::npos);
  }
}

class WrongMoteus : public testing::TestWithParam<test::BrokenText> {};

TEST_P(WrongMoteus, EndsAsOneLine) {
  test::SceneFiles files = moteusFiles();
  files.robot = test::replaced(files.robot, GetParam().from, GetParam().to);
  test::expectError(test::loadError(files.sources()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Keys, WrongMoteus,
    testing::Values(
        test::BrokenText{", data_bit_rate_per_s: 5e6", "", "robot.yaml:15:", "moteus on can0",
                         "a bus with data_bit_rate_per_s"},
        test::BrokenText{"node_id: 2, kind: moteus", "node_id: 2, kind: moteus, counts_per_rad: 5",
                         "robot.yaml:16:", "the drive is of kind moteus", "turns_per_rad"},
        test::BrokenText{"node_id: 2, kind: moteus", "node_id: 2, turns_per_rad: 5",
                         "robot.yaml:16:", "the drive is of kind cia402", "counts_per_rad"},
        test::BrokenText{"node_id: 2, kind: moteus", "node_id: 2, kind: moteus, turns_per_m: 5",
                         "robot.yaml:16:", "joint 'shoulder' is revolute", "turns_per_rad"},
        test::BrokenText{", turns_per_m: 100", "", "robot.yaml:15:", "is missing", "1/m"},
        test::BrokenText{"turns_per_m: 100", "turns_per_m: 9e3",
                         "robot.yaml:15:", "turns at the joint's limits are too many", "at most"},
        test::BrokenText{"turns_per_m: 100", "turns_per_m: 0", "robot.yaml:15:", "out of range",
                         "> 0"},
        test::BrokenText{"kind: moteus, turns_per_m: 100", "kind: moteux, turns_per_m: 100",
                         "robot.yaml:15:", "'moteux'", "one of cia402, moteus"},
        test::BrokenText{"node_id: 9, counts_per_rad: 2e6",
                         "node_id: 9, home: rotor, counts_per_rad: 2e6",
                         "robot.yaml:", "the drive is no moteus", "not this key"},
        test::BrokenText{"node_id: 2, kind: moteus", "node_id: 2, kind: moteus, home: relative",
                         "robot.yaml:16:", "'relative'", "one of output, rotor"},
        test::BrokenText{"node_id: 2, kind: moteus", "node_id: 2, kind: moteus, eds: a.eds",
                         "robot.yaml:16:", "no CANopen device", "not this key"},
        test::BrokenText{"interface: can1\n  first_id: 0x110", "interface: can0\n  first_id: 0xFE",
                         "robot.yaml:", "0x100 is the reply of moteus 1", "four ids"},
        // A moteus obeys whatever is in a frame to its node, and in one to all.
        test::BrokenText{"interface: can1\n  first_id: 0x110", "interface: can0\n  first_id: 0x2FF",
                         "robot.yaml:", "0x301 is one to moteus 1", "low bytes"},
        test::BrokenText{"interface: can1\n  first_id: 0x110", "interface: can0\n  first_id: 0x27C",
                         "robot.yaml:", "0x27f is one to moteus 1", "low bytes"},
        test::BrokenText{"node_id: 2, kind: moteus", "node_id: 127, kind: moteus",
                         "robot.yaml:16:", "127 is that of every moteus", "1 to 126"},
        test::BrokenText{"interface: can1, node_id: 9", "interface: can0, node_id: 127",
                         "robot.yaml:14:", "127 is that of every moteus", "1 to 126"}));

}  // namespace
}  // namespace tactus
