#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "support/hardware_files.h"

namespace tactus {
namespace {

using test::BrokenText;
using test::SceneFiles;

class BrokenHardware : public testing::TestWithParam<BrokenText> {};

TEST_P(BrokenHardware, EndsAsOneLine) {
  SceneFiles files = test::hardwareFiles();
  files.robot = test::replaced(files.robot, GetParam().from, GetParam().to);
  test::expectError(test::loadError(files.sources()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Buses, BrokenHardware,
    testing::Values(
        BrokenText{"{interface: can0}", "{interface: 'can 0'}",
                   "robot.yaml:6:19: can.buses[0].interface: ", "'can 0' is no name", "as can0"},
        BrokenText{"{interface: can0}", "{interface: ../can0}",
                   "robot.yaml:6:19: can.buses[0].interface: ", "is no name", "as can0"},
        BrokenText{"{interface: can0}", "{interface: ..}",
                   "robot.yaml:6:19: can.buses[0].interface: ", "is no name", "as can0"},
        BrokenText{"{interface: can0}", "{interface: a234567890123456}",
                   "robot.yaml:6:19: can.buses[0].interface: ", "is no name", "1 to 15 letters"},
        BrokenText{"{interface: can0}", "{interface: \"can\\n0\"}",
                   "robot.yaml:6:19: can.buses[0].interface: ", "'can\\x0a0' is no name",
                   "as can0"},
        BrokenText{"{interface: can0}", "{interface: ''}",
                   "robot.yaml:6:19: can.buses[0].interface: ", "the text ''", "text"},
        BrokenText{"{interface: can0}", "{interface: can1}",
                   "robot.yaml:7:19: can.buses[1].interface: ", "'can1' is given twice", "once"},
        BrokenText{"bit_rate_per_s: 9e5", "bit_rate_per_s: 9e5, data_bit_rate_per_s: 8e5",
                   "robot.yaml:7:67: can.buses[1].data_bit_rate_per_s: ", "less than the bit rate",
                   "at least bit_rate_per_s = 900000"},
        BrokenText{"bit_rate_per_s: 9e5", "bit_rate_per_s: 2e6",
                   "robot.yaml:7:41: can.buses[1].bit_rate_per_s: ", "out of range",
                   "from 10000 to 1000000"},
        BrokenText{"{interface: can0}", "{interface: can0}\n    - {interface: can2}",
                   "robot.yaml:7:7: can.buses[1]: ", "nothing is on 'can2'", "no such bus"},
        BrokenText{"  buses:\n    - {interface: can0}\n    - {interface: can1, bit_rate_per_s: "
                   "9e5}\n",
                   "", "robot.yaml:5:3: can.buses: ", "is missing", "a list of 1 to 8 sections"},
        BrokenText{"    - {interface: can0}\n    - {interface: can1, bit_rate_per_s: 9e5}\n",
                   "    []\n", "robot.yaml:6:5: can.buses: ", "a list of 0", "1 to 8 sections"},
        BrokenText{"master_node_id: 100", "master_node_id: 128",
                   "robot.yaml:8:19: can.master_node_id: ", "out of range", "from 1 to 127"},
        BrokenText{"master_node_id: 100", "master_node_id: 9",
                   "robot.yaml:14:47: drives.joints[0].node_id: ", "9 is the master's",
                   "another one"},
        BrokenText{"heartbeat_timeout_s: 0.1", "heartbeat_timeout_s: 0.079",
                   "robot.yaml:10:24: can.heartbeat_timeout_s: ", "no room for a heartbeat",
                   "at least twice heartbeat_period_s, 0.08"},
        BrokenText{"heartbeat_period_s: 0.04", "heartbeat_period_s: 0.0405",
                   "robot.yaml:9:23: can.heartbeat_period_s: ", "no whole number of milliseconds",
                   "CANopen"},
        BrokenText{"heartbeat_timeout_s: 0.1", "heartbeat_timeout_s: 66",
                   "robot.yaml:10:24: can.heartbeat_timeout_s: ", "out of range",
                   "from 0.001 to 65.535 in s"}));

INSTANTIATE_TEST_SUITE_P(
    Drives, BrokenHardware,
    testing::Values(
        BrokenText{"joint: roll", "joint: rol", "robot.yaml:14:15: drives.joints[0].joint: ",
                   "'rol' is no moving joint", "one of lift, shoulder, roll"},
        BrokenText{"joint: roll", "joint: spacer_fixed",
                   "robot.yaml:14:15: drives.joints[0].joint: ", "no moving joint", "one of lift"},
        BrokenText{"joint: shoulder", "joint: lift", "robot.yaml:16:15: drives.joints[2].joint: ",
                   "'lift' has a drive already, in entry 1", "each joint once"},
        BrokenText{"    - {joint: shoulder, interface: can0, node_id: 2, counts_per_rad: 1e6, "
                   "offset_rad: -0.5}\n",
                   "", "robot.yaml:14:5: drives.joints: ", "no drive of joint 'shoulder'",
                   "one a moving joint"},
        BrokenText{"interface: can1, node_id: 9", "interface: can2, node_id: 9",
                   "robot.yaml:14:32: drives.joints[0].interface: ", "'can2' is none of can.buses",
                   "one of can0, can1"},
        BrokenText{"node_id: 2,", "node_id: 1,", "robot.yaml:16:51: drives.joints[2].node_id: ",
                   "1 is that of joint 'lift' on the same bus", "once a bus"},
        BrokenText{"node_id: 2,", "node_id: 0,", "robot.yaml:16:51: drives.joints[2].node_id: ",
                   "out of range", "a whole number from 1 to 127"},
        BrokenText{"node_id: 2,", "", "robot.yaml:16:7: drives.joints[2].node_id: ", "is missing",
                   "from 1 to 127"},
        BrokenText{"sign: -1", "sign: 0",
                   "robot.yaml:14:77: drives.joints[0].sign: ", "'0' is no sign", "1 or -1"},
        BrokenText{"sign: -1", "sign: 2",
                   "robot.yaml:14:77: drives.joints[0].sign: ", "out of range", "from -1 to 1"},
        BrokenText{"counts_per_m: 1e7", "counts_per_rad: 1e7",
                   "robot.yaml:15:66: drives.joints[1].counts_per_rad: ",
                   "joint 'lift' is prismatic", "counts_per_m"},
        BrokenText{"counts_per_rad: 2e6", "counts_per_m: 2e6",
                   "robot.yaml:14:64: drives.joints[0].counts_per_m: ", "joint 'roll' is revolute",
                   "counts_per_rad"},
        BrokenText{"counts_per_m: 1e7", "counts_per_m: 1e7, counts_per_rad: 1e7",
                   "robot.yaml:15:85: drives.joints[1].counts_per_rad: ",
                   "joint 'lift' is prismatic", "counts_per_m"},
        BrokenText{"offset_m: 0.25", "offset_rad: 0.25",
                   "robot.yaml:15:81: drives.joints[1].offset_rad: ", "joint 'lift' is prismatic",
                   "offset_m"},
        BrokenText{"max_following_error_m: 0.01", "max_following_error_rad: 0.01",
                   "robot.yaml:15:110: drives.joints[1].max_following_error_rad: ",
                   "joint 'lift' is prismatic", "max_following_error_m"},
        BrokenText{"counts_per_m: 1e7, ", "",
                   "robot.yaml:15:7: drives.joints[1].counts_per_m: ", "is missing", "in 1/m"},
        BrokenText{"counts_per_rad: 2e6, ", "",
                   "robot.yaml:14:7: drives.joints[0].counts_per_rad: ", "is missing", "in 1/rad"},
        BrokenText{"counts_per_m: 1e7", "counts_per_m: 0",
                   "robot.yaml:15:64: drives.joints[1].counts_per_m: ", "out of range",
                   "from 1 to 1000000000 in 1/m"},
        // 2^31 - 1 counts over 3 rad and 0.05 rad of following error.
        BrokenText{"counts_per_rad: 2e6", "counts_per_rad: 704093000",
                   "robot.yaml:14:66: drives.joints[0].counts_per_rad: ", "do not fit into 32 bits",
                   "at most 7.04093e+08"},
        BrokenText{"offset_m: 0.25", "offset_m: 1000",
                   "robot.yaml:15:64: drives.joints[1].counts_per_m: ", "do not fit into 32 bits",
                   "at most 2.14"},
        BrokenText{"tracking_gain_per_s: 10", "tracking_gain_per_s: 36",
                   "robot.yaml:14:102: drives.joints[0].tracking_gain_per_s: ", "36 is too high",
                   "at most 1 / (4 (position_lag_s + 2 period_s)) = 35.71"},
        BrokenText{"start_tolerance: 0.03", "start_tolerance: 0",
                   "robot.yaml:12:20: drives.start_tolerance: ", "out of range", "in m or rad"}));

INSTANTIATE_TEST_SUITE_P(
    Module, BrokenHardware,
    testing::Values(
        BrokenText{"tactile_module:\n  interface: can1", "tactile_module:\n  interface: can7",
                   "robot.yaml:18:14: tactile_module.interface: ", "'can7' is none of can.buses",
                   "one of can0, can1"},
        BrokenText{"tactile_module:\n  interface: can1\n", "tactile_module:\n",
                   "robot.yaml:18:3: tactile_module.interface: ", "is missing",
                   "one of can0, can1"},
        BrokenText{"first_id: 0x110", "first_id: 0x7FD",
                   "robot.yaml:19:13: tactile_module.first_id: ", "'0x7FD' is out of range",
                   "from 1 to 2044"},
        BrokenText{"first_id: 0x110", "first_id: 0x", "robot.yaml:19:13: tactile_module.first_id: ",
                   "'0x' is not a whole number", "a whole number"},
        BrokenText{"first_id: 0x110", "first_id: 0x-110",
                   "robot.yaml:19:13: tactile_module.first_id: ", "is not a whole number",
                   "a whole number"},
        BrokenText{"first_id: 0x110", "first_id: -0x110",
                   "robot.yaml:19:13: tactile_module.first_id: ", "is not a whole number",
                   "a whole number"},
        BrokenText{"first_id: 0x110", "first_id: 0x100000000",
                   "robot.yaml:19:13: tactile_module.first_id: ", "is out of range",
                   "a whole number"},
        BrokenText{"filter_in_daemon: true", "filter_in_daemon: 1",
                   "robot.yaml:20:21: tactile_module.filter_in_daemon: ", "'1'", "true or false"},
        BrokenText{"filter_in_daemon: true", "filter_in_daemon: true\n  filter_cutoff_hz: 100",
                   "robot.yaml:21:21: tactile_module.filter_cutoff_hz: ",
                   "100 Hz is too high for a filter in the daemon", "200 Hz"},
        BrokenText{"tare: {samples: 20}", "tare: {samples: 0}",
                   "robot.yaml:21:19: tactile_module.tare.samples: ", "out of range",
                   "from 1 to 10000"}));

INSTANTIATE_TEST_SUITE_P(
    Lines, BrokenHardware,
    testing::Values(
        BrokenText{"chip: gpiochip1", "chip: /dev/gpiochip1",
                   "robot.yaml:32:9: gpio.chip: ", "'/dev/gpiochip1' is no name", "gpiochip0"},
        BrokenText{"chip: gpiochip1", "chip: FILL_IN",
                   "robot.yaml:32:9: gpio.chip: ", "'FILL_IN' is left", "text"},
        BrokenText{"  chip: gpiochip1\n", "", "robot.yaml:32:3: gpio.chip: ", "is missing", "text"},
        BrokenText{"brake: {line: 5}", "brake: {line: 3}", "robot.yaml:34:17: gpio.brake.line: ",
                   "line 3 is e_stop's", "a line of its own"},
        BrokenText{"brake: {line: 5}", "brake: {line: -1}",
                   "robot.yaml:34:17: gpio.brake.line: ", "out of range", "from 0 to 65535"},
        BrokenText{"brake: {line: 5}", "brake: {active_low: true}",
                   "robot.yaml:34:10: gpio.brake.line: ", "is missing", "a whole number"},
        BrokenText{"brake: {line: 5}", "brake: {line: 5, debounce_s: 0.1}",
                   "robot.yaml:34:20: gpio.brake.debounce_s: ", "unknown key",
                   "one of line, active_low"},
        BrokenText{"  e_stop: {line: 3, active_low: true, debounce_s: 0.01}\n  brake: {line: 5}\n",
                   "", "robot.yaml:32:3: gpio: ", "no line", "one of e_stop, enable"},
        BrokenText{"priority: 70", "priority: 99",
                   "robot.yaml:35:23: real_time.priority: ", "out of range", "from 1 to 98"},
        BrokenText{"cpu: 1", "cpu: -2", "robot.yaml:35:32: real_time.cpu: ", "out of range",
                   "from -1 to 1023"},
        BrokenText{"cpu: 1", "core: 1", "robot.yaml:35:27: real_time.core: ", "unknown key",
                   "one of priority, cpu, max_late_cycles"},
        BrokenText{"cpu: 1", "required: false",
                   "robot.yaml:35:27: real_time.required: ", "unknown key here", "in a scene"}));

/// The ids of CiA 301 on the bus of the module: SYNC, EMCY, PDOs, SDO and heartbeats of drive and
/// master; any of the module's four frames may hit one.
class ModuleId : public testing::TestWithParam<std::pair<int, std::string>> {};

TEST_P(ModuleId, HitsAnotherFrame) {
  const auto& [id, name] = GetParam();
  for (int first_id = std::max(1, id - 4); first_id <= std::min(id + 1, 0x7FC); ++first_id) {
    SceneFiles files = test::hardwareFiles();
    files.robot =
        test::replaced(files.robot, "first_id: 0x110", fmt::format("first_id: {}", first_id));
    const std::string error = test::loadError(files.sources());
    if (first_id <= id && id <= first_id + 3) {
      test::expectError(error, {"", name, "robot.yaml:19:13: tactile_module.first_id: ",
                                fmt::format("frame {:#05x} is the {} on the same bus", id, name),
                                "four ids of its own"});
    } else {
      EXPECT_EQ(error.find(fmt::format("{:#05x}", id)), std::string::npos) << error;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, ModuleId,
    testing::Values(std::pair{0x080, "SYNC"}, std::pair{0x089, "EMCY of node 9"},
                    std::pair{0x189, "TPDO1 of node 9"}, std::pair{0x209, "RPDO1 of node 9"},
                    std::pair{0x589, "SDO answer of node 9"},
                    std::pair{0x609, "SDO request of node 9"},
                    std::pair{0x709, "heartbeat of node 9"},
                    std::pair{0x764, "heartbeat of the master"}),
    [](const auto& instance) { return fmt::format("{:x}", instance.param.first); });

/// Ids of the other bus do not matter.
TEST(ModuleIds, OfDrivesOnAnotherBusAreFree) {
  SceneFiles files = test::hardwareFiles();
  files.robot = test::replaced(files.robot, "first_id: 0x110", "first_id: 0x1FE");
  EXPECT_EQ(test::loadError(files.sources()), "") << "0x201 is RPDO1 of node 1 on can0";
}

/// What only makes sense on hardware is refused without the section that makes it such.
TEST(RobotWithoutCan, RefusesKeysOfHardware) {
  const std::vector<std::pair<std::string, std::string>> additions = {
      {"drives.joints",
       "drives: {joints: [{joint: lift, interface: can0, node_id: 1, counts_per_m: 1e6}]}\n"},
      {"drives.start_tolerance", "drives: {start_tolerance: 0.1}\n"},
      {"gpio", "gpio: {chip: gpiochip0, brake: {line: 1}}\n"},
      {"real_time", "real_time: {priority: 50}\n"}};
  for (const auto& [key, text] : additions) {
    SceneFiles files;
    files.robot = test::replaced(files.robot, "drives: {position_lag_s: 0.01}\n", text);
    const std::string error = test::loadError(files.sources());
    EXPECT_NE(error.find(": " + key + ": the robot has no can section, expected one"),
              std::string::npos)
        << error;
  }
  for (const char* key :
       {"interface: can0", "first_id: 0x100", "filter_in_daemon: true", "tare: {}"}) {
    SceneFiles files;
    files.robot =
        test::replaced(files.robot, "  link: cover", std::string("  ") + key + "\n  link: cover");
    const std::string error = test::loadError(files.sources());
    EXPECT_EQ(error.substr(0, 13), "robot.yaml:8:") << key << error;
    EXPECT_NE(
        error.find(std::string(key).starts_with("interface") ? "no can section" : "on no bus"),
        std::string::npos)
        << error;
  }
}

TEST(RobotWithCan, NeedsItsDrives) {
  SceneFiles files = test::hardwareFiles();
  const std::size_t joints = files.robot.find("  joints:");
  files.robot.erase(joints, files.robot.find("tactile_module:") - joints);
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.yaml:12:3: drives.joints: ", "is missing",
                     "a list of one drive a moving joint"});
}

/// Cut after every byte: never anything but a scene or a proper error.
TEST(RobotWithCan, MayBeTruncatedAnywhere) {
  const SceneFiles whole = test::hardwareFiles();
  for (std::size_t length = 0; length < whole.robot.size(); ++length) {
    SceneFiles files = whole;
    files.robot.resize(length);
    const std::string error = test::loadError(files.sources());
    if (error.empty()) continue;
    EXPECT_NE(error.find(", expected "), std::string::npos) << error;
  }
}

TEST(RobotWithCan, CannotHaveJointsThatTurnForever) {
  SceneFiles files = test::hardwareFiles();
  files.urdf = test::kUrdfText;
  test::expectError(test::loadError(files.sources()),
                    {"", "", "robot.yaml:14:15: drives.joints[0].joint: ", "turns without limits",
                     "limits in the URDF"});
}

TEST(RobotWithCan, CannotHaveVelocitiesThatOverflow) {
  SceneFiles files = test::hardwareFiles();
  files.urdf = test::replaced(files.urdf, "velocity=\"0.7\"", "velocity=\"250\"");
  test::expectError(
      test::loadError(files.sources()),
      {"", "", "robot.yaml:15:64: drives.joints[1].counts_per_m: ",
       "2.5e+09 counts at the joint's limits do not fit into 32 bits", "at most 8.58993e+06"});
}

TEST(RobotWithCan, HasACycleThatDrivesCanBeToldOf) {
  SceneFiles files = test::hardwareFiles();
  files.scene = "period_s: 0.0003333333333333333\n" + files.scene;
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:1:11: period_s: ",
                     "drives cannot be told of 0.0003333333333333333 s", "60C2"});
}

/// The loop reads so many at once, and takes full batches for a flood.
TEST(RobotWithCan, HasNoMoreFramesACycleThanAreRead) {
  SceneFiles files = test::hardwareFiles();
  files.robot = test::replaced(files.robot, "sample_period_s: 0.005",
                               "sample_period_s: 0.001\n  max_sample_age_s: 0.05");
  files.robot = test::replaced(files.robot, "tracking_gain_per_s: 10", "tracking_gain_per_s: 5");
  test::expectError(test::loadError(files.sources(), {{"period_s", "0.02"}}),
                    {"", "", "robot.yaml:7:7: can.buses[1]: ", "can1 has up to 85 frames a cycle: ",
                     "at most 63: a shorter period_s"});
  EXPECT_EQ(test::loadError(files.sources(), {{"period_s", "0.01"}}), "");
}

/// A deadline in another unit would close brakes while the arm moves.
TEST(RobotWithCan, HasTenCyclesForAStop) {
  const test::SceneFiles files = test::hardwareFiles();
  const auto errorWith = [&](const std::string& deadline_s) {
    return test::loadError(files.sources(), {{"robot.can.stop_deadline_s", deadline_s}});
  };
  EXPECT_EQ(errorWith("0.01"), "");
  const std::string error = errorWith("0.0005");
  EXPECT_NE(error.find("can.stop_deadline_s: 0.0005 s is shorter than ten cycles, expected at "
                       "least 0.01 s"),
            std::string::npos)
      << error;
}

TEST(RobotWithCan, SendsHeartbeatsAtMostOnceACycle) {
  SceneFiles files = test::hardwareFiles();
  files.robot =
      test::replaced(files.robot, "heartbeat_period_s: 0.04", "heartbeat_period_s: 0.004");
  test::expectError(test::loadError(files.sources(), {{"period_s", "0.005"}}),
                    {"", "", "robot.yaml:9:23: can.heartbeat_period_s: ",
                     "0.004 s is shorter than a cycle", "at least the scene's period_s = 0.005"});
}

}  // namespace
}  // namespace tactus
