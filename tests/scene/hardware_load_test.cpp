#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/hardware_files.h"
#include "tactus/scene/bus_load_text.h"

namespace tactus {
namespace {

using test::hardwareFiles;
using test::SceneFiles;

std::string shipped(const std::string& path) {
  return std::string(TACTUS_SOURCE_DIR) + "/config/" + path;
}

std::vector<std::string> interfaces(const HardwareConfig& hardware) {
  std::vector<std::string> names;
  for (const BusConfig& bus : hardware.buses) names.push_back(bus.interface);
  return names;
}

TEST(HardwareLoad, PutsBusesInTheirPlace) {
  const HardwareConfig hardware = hardwareFiles().load().hardware.value();
  EXPECT_EQ(interfaces(hardware), (std::vector<std::string>{"can0", "can1"}));
  EXPECT_EQ(hardware.buses[0].bit_rate_per_s, 1e6);
  EXPECT_EQ(hardware.buses[1].bit_rate_per_s, 9e5);
  EXPECT_EQ(hardware.canopen.master_node_id, 100);
  EXPECT_EQ(hardware.canopen.heartbeat_period_s, 0.04);
  EXPECT_EQ(hardware.canopen.heartbeat_timeout_s, 0.1);
  EXPECT_EQ(hardware.start_tolerance, 0.03);
}

TEST(HardwareLoad, ABusOfCanFdHasARateOfItsData) {
  SceneFiles files = hardwareFiles();
  EXPECT_FALSE(files.load().hardware->buses[0].data_bit_rate_per_s);
  files.robot = test::replaced(files.robot, "{interface: can0}",
                               "{interface: can0, data_bit_rate_per_s: 5e6}");
  const HardwareConfig hardware = files.load().hardware.value();
  EXPECT_EQ(hardware.buses[0].data_bit_rate_per_s, 5e6);
  EXPECT_EQ(busLoads(hardware, 0.001)[0].share(),
            busLoads(hardwareFiles().load().hardware.value(), 0.001)[0].share())
      << "CANopen's frames are as long as ever";
}

TEST(HardwareLoad, DeadlineOfAStopNeedsNoLines) {
  SceneFiles files = hardwareFiles();
  EXPECT_EQ(files.load().hardware->canopen.stop_deadline_s, CanopenConfig{}.stop_deadline_s);
  files.robot = test::replaced(files.robot, "can:\n", "can:\n  stop_deadline_s: 0.7\n");
  files.robot.resize(files.robot.find("gpio:"));
  const HardwareConfig hardware = files.load().hardware.value();
  EXPECT_EQ(hardware.canopen.stop_deadline_s, 0.7);
  EXPECT_FALSE(hardware.gpio);
}

TEST(HardwareLoad, PutsDrivesIntoTheOrderOfTheJoints) {
  const HardwareConfig hardware = hardwareFiles().load().hardware.value();
  ASSERT_EQ(hardware.drives.size(), 3u);
  const DriveConfig& lift = hardware.drives[0];
  const DriveConfig& shoulder = hardware.drives[1];
  const DriveConfig& roll = hardware.drives[2];
  EXPECT_EQ(lift.joint, 0);
  EXPECT_EQ(lift.bus, 0);
  EXPECT_EQ(lift.node_id, 1);
  EXPECT_EQ(lift.counts_per_unit, 1e7);
  EXPECT_EQ(lift.offset, 0.25);
  EXPECT_EQ(lift.sign, 1);
  EXPECT_EQ(lift.max_following_error, 0.01);
  EXPECT_EQ(lift.tracking_gain_per_s, 0.0);
  EXPECT_EQ(shoulder.joint, 1);
  EXPECT_EQ(shoulder.node_id, 2);
  EXPECT_EQ(shoulder.counts_per_unit, 1e6);
  EXPECT_EQ(shoulder.offset, -0.5);
  EXPECT_EQ(roll.joint, 2);
  EXPECT_EQ(roll.bus, 1);
  EXPECT_EQ(roll.node_id, 9);
  EXPECT_EQ(roll.counts_per_unit, 2e6);
  EXPECT_EQ(roll.sign, -1);
  EXPECT_EQ(roll.tracking_gain_per_s, 10.0);
}

TEST(HardwareLoad, PutsTheModuleInItsPlace) {
  const Scene scene = hardwareFiles().load();
  const CanTactileConfig module = scene.hardware.value().tactile_modules.at(0);
  EXPECT_EQ(module.bus, 1);
  EXPECT_EQ(module.first_id, 0x110u);
  EXPECT_EQ(module.channels.calibration, scene.plant.modules[0].channels.calibration);
  EXPECT_EQ(module.channels.counts_per_N, scene.plant.modules[0].channels.counts_per_N);
  EXPECT_EQ(module.channels.sample_period_s, 0.005);
  EXPECT_EQ(module.filter_cutoff_hz, 15.0);
  EXPECT_EQ(module.tare_samples, 20);
}

TEST(HardwareLoad, FiltersInTheModuleUnlessTold) {
  SceneFiles files = hardwareFiles();
  files.robot = test::replaced(files.robot, "filter_in_daemon: true", "filter_in_daemon: false");
  EXPECT_FALSE(files.load().hardware.value().tactile_modules.at(0).filter_cutoff_hz);
}

/// Which the daemon does not have, and simulations could not show.
TEST(HardwareLoad, TakesNoOtherFilterOfAModuleThatHasNone) {
  SceneFiles files = hardwareFiles();
  const std::vector<Override> other{{"simulation.tactile_module.filter_cutoff_hz", "8"}};
  EXPECT_NE(test::loadError(files.sources(), other)
                .find("simulation.tactile_module.filter_cutoff_hz: has no filter: the daemon has"),
            std::string::npos);
  files.robot = test::replaced(files.robot, "filter_in_daemon: true", "filter_in_daemon: false");
  EXPECT_EQ(files.load(other).plant.modules[0].filter_cutoff_hz, 8.0);
}

TEST(HardwareLoad, PutsLinesAndRealTimeInTheirPlace) {
  const HardwareConfig hardware =
      hardwareFiles().load({{"real_time.required", "false"}}).hardware.value();
  const GpioConfig gpio = hardware.gpio.value();
  EXPECT_EQ(gpio.chip, "gpiochip1");
  EXPECT_EQ(gpio.e_stop.value().line, 3);
  EXPECT_TRUE(gpio.e_stop.value().active_low);
  EXPECT_EQ(gpio.e_stop.value().debounce_s, 0.01);
  EXPECT_FALSE(gpio.enable);
  EXPECT_EQ(gpio.brake.value().line, 5);
  EXPECT_FALSE(gpio.brake.value().active_low);
  EXPECT_FALSE(gpio.heartbeat);
  EXPECT_EQ(hardware.real_time.priority, 70);
  EXPECT_EQ(hardware.real_time.cpu, 1);
  EXPECT_EQ(hardware.real_time.max_late_cycles, 3);
  EXPECT_FALSE(hardware.real_time.required);
  EXPECT_TRUE(hardwareFiles().load().hardware.value().real_time.required) << "unless told";
}

/// The structs are filled by hand in tests: their initialisers and the table must not drift apart.
TEST(HardwareLoad, DefaultsEqualThoseOfTheStructs) {
  SceneFiles files = hardwareFiles();
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"  master_node_id: 100\n  heartbeat_period_s: 0.04\n  heartbeat_timeout_s: 0.1\n", ""},
           {"  start_tolerance: 0.03\n", ""},
           {", offset_rad: -0.5", ""},
           {"  first_id: 0x110\n  filter_in_daemon: true\n  tare: {samples: 20}\n", ""},
           {"  sample_period_s: 0.005\n", ""},
           {"real_time: {priority: 70, cpu: 1}\n", ""},
           {", active_low: true, debounce_s: 0.01", ""}}) {
    files.robot = test::replaced(files.robot, from, to);
  }
  const HardwareConfig hardware = files.load().hardware.value();
  const HardwareConfig none;
  EXPECT_EQ(hardware.buses[0].bit_rate_per_s, BusConfig{}.bit_rate_per_s);
  EXPECT_EQ(hardware.canopen.master_node_id, none.canopen.master_node_id);
  EXPECT_EQ(hardware.canopen.heartbeat_period_s, none.canopen.heartbeat_period_s);
  EXPECT_EQ(hardware.canopen.heartbeat_timeout_s, none.canopen.heartbeat_timeout_s);
  EXPECT_EQ(hardware.canopen.sdo_timeout_s, none.canopen.sdo_timeout_s);
  EXPECT_EQ(hardware.canopen.boot_timeout_s, none.canopen.boot_timeout_s);
  EXPECT_EQ(hardware.start_tolerance, none.start_tolerance);
  const DriveConfig& drive = hardware.drives[1];
  EXPECT_EQ(drive.offset, DriveConfig{}.offset);
  EXPECT_EQ(drive.sign, DriveConfig{}.sign);
  EXPECT_EQ(drive.max_following_error, DriveConfig{}.max_following_error);
  EXPECT_EQ(drive.tracking_gain_per_s, DriveConfig{}.tracking_gain_per_s);
  const CanTactileConfig module = hardware.tactile_modules.at(0);
  const CanTactileConfig module_default;
  EXPECT_EQ(module.first_id, module_default.first_id);
  EXPECT_EQ(module.channels.counts_per_N, module_default.channels.counts_per_N);
  EXPECT_EQ(module.filter_cutoff_hz, module_default.filter_cutoff_hz);
  EXPECT_EQ(module.channels.sample_period_s, module_default.channels.sample_period_s);
  EXPECT_EQ(module.tare_samples, module_default.tare_samples);
  EXPECT_EQ(module.tare_max_offset_N, module_default.tare_max_offset_N);
  EXPECT_EQ(module.tare_max_spread_N, module_default.tare_max_spread_N);
  const GpioLineConfig line = hardware.gpio.value().e_stop.value();
  EXPECT_EQ(line.active_low, GpioLineConfig{}.active_low);
  EXPECT_EQ(line.debounce_s, GpioLineConfig{}.debounce_s);
  EXPECT_EQ(hardware.real_time.priority, none.real_time.priority);
  EXPECT_EQ(hardware.real_time.cpu, none.real_time.cpu);
  EXPECT_EQ(hardware.real_time.max_late_cycles, none.real_time.max_late_cycles);
  EXPECT_EQ(hardware.real_time.required, none.real_time.required);
}

TEST(HardwareLoad, IsAbsentWithoutCan) { EXPECT_FALSE(SceneFiles{}.load().hardware); }

/// Without a controller nobody reads the module: its bus is not opened if nothing else is on it.
TEST(HardwareLoad, LeavesOutTheBusOfAnUnreadModule) {
  SceneFiles files = hardwareFiles();
  files.robot = test::replaced(files.robot, "{interface: can0}",
                               "{interface: can9}\n    - {interface: can0}");
  files.robot = test::replaced(files.robot, "tactile_module:\n  interface: can1",
                               "tactile_module:\n  interface: can9");
  EXPECT_EQ(interfaces(files.load().hardware.value()),
            (std::vector<std::string>{"can9", "can0", "can1"}));
  const HardwareConfig hardware =
      files.load({{"controller", "null"}, {"stiffness", "null"}}).hardware.value();
  EXPECT_TRUE(hardware.tactile_modules.empty());
  EXPECT_EQ(interfaces(hardware), (std::vector<std::string>{"can0", "can1"}));
  EXPECT_EQ(hardware.drives[0].bus, 0);
  EXPECT_EQ(hardware.drives[1].bus, 0);
  EXPECT_EQ(hardware.drives[2].bus, 1);
}

TEST(HardwareLoad, KeepsTheBusThatAnUnreadModuleShares) {
  const HardwareConfig hardware =
      hardwareFiles().load({{"controller", "null"}, {"stiffness", "null"}}).hardware.value();
  EXPECT_TRUE(hardware.tactile_modules.empty());
  EXPECT_EQ(interfaces(hardware), (std::vector<std::string>{"can0", "can1"}));
}

TEST(HardwareLoad, NamesTheStagesOfHardwareApart) {
  SceneFiles files = hardwareFiles();
  EXPECT_EQ(hardwareStageNames(*files.load().hardware), (std::vector<std::string>{"can", "gpio"}));
  const std::size_t gpio = files.robot.find("gpio:");
  files.robot.erase(gpio, files.robot.find("real_time:") - gpio);
  EXPECT_EQ(hardwareStageNames(*files.load().hardware), std::vector<std::string>{"can"});
  for (const std::string& stage : stageNames(files.load().controller)) {
    EXPECT_TRUE(stage != "can" && stage != "gpio") << "simulation has none";
  }
}

TEST(ShippedRobot, HasThreeDrivesABusAndTheModuleOnTheFourth) {
  const Scene scene = loadScene(shipped("scenes/scenario1_multi_space.yaml"), {});
  const HardwareConfig hardware = scene.hardware.value();
  EXPECT_EQ(interfaces(hardware), (std::vector<std::string>{"can0", "can1", "can2", "can3"}));
  ASSERT_EQ(hardware.drives.size(), 9u);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(hardware.drives[i].joint, i);
    EXPECT_EQ(hardware.drives[i].bus, i / 3);
    EXPECT_EQ(hardware.drives[i].node_id, i % 3 + 1);
  }
  EXPECT_EQ(hardware.tactile_modules.at(0).bus, 3);
  EXPECT_FALSE(hardware.gpio) << "a trial on vcan has no lines";
}

TEST(ShippedRobot, WithLinesHasTheSameDrivesAndModules) {
  const std::string scene = shipped("scenes/scenario1_multi_space.yaml");
  const HardwareConfig plain = loadScene(scene, {}).hardware.value();
  const HardwareConfig lines =
      loadScene(scene, {{"robot", "../robots/crops9/robot_with_lines.yaml"}}).hardware.value();
  ASSERT_TRUE(lines.gpio && lines.gpio->e_stop && lines.gpio->enable && lines.gpio->brake &&
              lines.gpio->heartbeat);
  EXPECT_TRUE(lines.gpio->e_stop->active_low);
  EXPECT_EQ(interfaces(lines), interfaces(plain));
  EXPECT_EQ(lines.start_tolerance, plain.start_tolerance);
  EXPECT_EQ(lines.canopen.heartbeat_period_s, plain.canopen.heartbeat_period_s);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(lines.drives[i].node_id, plain.drives[i].node_id);
    EXPECT_EQ(lines.drives[i].counts_per_unit, plain.drives[i].counts_per_unit);
    EXPECT_EQ(lines.drives[i].offset, plain.drives[i].offset);
    EXPECT_EQ(lines.drives[i].max_following_error, plain.drives[i].max_following_error);
  }
  EXPECT_EQ(lines.tactile_modules.at(0).channels.calibration,
            plain.tactile_modules.at(0).channels.calibration);
}

/// The shipped scene without contact, with drives moved to the first bus.
std::vector<SourceFile> withDrivesOnFirstBus(int count) {
  std::vector<SourceFile> sources = loadScene(shipped("scenes/free_motion.yaml"), {}).sources;
  for (SourceFile& file : sources) {
    if (!file.path.ends_with("crops9/robot.yaml")) continue;
    for (int joint = 4; joint <= count; ++joint) {
      const std::string from =
          fmt::format("{{joint: j{}, interface: can1, node_id: {},", joint, joint - 3);
      const std::string to =
          fmt::format("{{joint: j{}, interface: can0, node_id: {},", joint, joint);
      file.text = test::replaced(file.text, from, to);
    }
  }
  return sources;
}

TEST(BusLoad, ThreeDrivesAtAKilohertzAreAccepted) {
  const Scene scene = loadScene(withDrivesOnFirstBus(3), {});
  const std::vector<BusLoad> loads = busLoads(*scene.hardware, scene.period_s);
  ASSERT_EQ(loads.size(), 3u);
  EXPECT_EQ(describeBusLoad(loads[0], scene.period_s),
            "3 x 115 (RPDO1) + 3 x 115 (TPDO1) + 1 x 55 (SYNC) + 4 x 65 / 20 (heartbeats) = 758 "
            "bits a cycle of 1000 = 75.8 %");
}

TEST(BusLoad, ThreeDrivesFasterAreRefused) {
  const std::string error = test::loadError(withDrivesOnFirstBus(3), {{"period_s", "0.0009"}});
  EXPECT_NE(
      error.find("crops9/robot.yaml:19:7: can.buses[0]: can0 is overloaded: 3 x 115 (RPDO1) + "
                 "3 x 115 (TPDO1) + 1 x 55 (SYNC) + 4 x 65 / 22.22 (heartbeats) = 756.7 bits "
                 "a cycle of 900 = 84.08 %, expected at most 80 %"),
      std::string::npos)
      << error;
}

TEST(BusLoad, ConcernsNoSimulation) {
  const std::vector<SourceFile> sources = withDrivesOnFirstBus(4);
  const Scene scene = loadScene(sources, {{"period_s", "0.00025"}}, SceneUse::kSimulation);
  EXPECT_EQ(scene.period_s, 0.00025);
  EXPECT_TRUE(scene.hardware);
}

TEST(BusLoad, FourDrivesOnABusAreRefused) {
  const std::string error = test::loadError(withDrivesOnFirstBus(4));
  EXPECT_NE(error.find("can.buses[0]: can0 is overloaded: 4 x 115 (RPDO1) + 4 x 115 (TPDO1) + "
                       "1 x 55 (SYNC) + 5 x 65 / 20 (heartbeats) = 991.2 bits a cycle of 1000 = "
                       "99.12 %, expected at most 80 %"),
            std::string::npos)
      << error;
  EXPECT_EQ(test::loadError(withDrivesOnFirstBus(4), {{"period_s", "0.002"}}), "");
}

}  // namespace
}  // namespace tactus
