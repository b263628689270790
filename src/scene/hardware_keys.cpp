#include "tactus/scene/hardware_keys.h"

#include <fmt/format.h>

namespace tactus {
namespace {

using namespace keys;

// CANopen counts these times in 16 bits of milliseconds.
constexpr double kMaxHeartbeat_s = 65.535;
constexpr double kMaxCounts = 1e9;  // a unit or s; more does not fit into INTEGER32 anyway

Needs canOfTheRobot() { return {"can", "the robot has no can section", "one, or not this key"}; }

/// A module that is on a bus, or not: without buses it is on none.
Needs busOfTheModule() {
  return {"can", "the module is on no bus", "its interface, or not this key"};
}

Table<BusConfig> busKeys() {
  return {
      text("interface", "CAN network interface", &BusConfig::interface),
      number("bit_rate_per_s", "1/s", within(10e3, 1e6), "of the bus", &BusConfig::bit_rate_per_s),
      number("data_bit_rate_per_s", "1/s", within(10e3, 8e6),
             "of the data of CAN FD frames; absent: the bus is classic CAN",
             &BusConfig::data_bit_rate_per_s),
  };
}

Table<CanopenConfig> canopenKeys() {
  using Config = CanopenConfig;
  return {
      integer("master_node_id", within(1, 127), "node id of the daemon", &Config::master_node_id),
      number("heartbeat_period_s", "s", within(0.001, kMaxHeartbeat_s),
             "of daemon and drives, whole milliseconds", &Config::heartbeat_period_s),
      number("heartbeat_timeout_s", "s", within(0.001, kMaxHeartbeat_s),
             "silence after which the other side is taken for dead, and a drive "
             "with object 1400:05 misses its setpoints, whole milliseconds; at least twice "
             "heartbeat_period_s",
             &Config::heartbeat_timeout_s),
      number("sdo_timeout_s", "s", within(0.001, 10),
             "for a drive to answer while it is configured", &Config::sdo_timeout_s),
      number("boot_timeout_s", "s", within(0.1, 600), "for all drives to be configured",
             &Config::boot_timeout_s),
      number("stop_deadline_s", "s", above(0, 60),
             "after a fault, longer than the longest quick stop: brakes are closed by then, "
             "and drives not seen off are cut off from the bus",
             &Config::stop_deadline_s),
  };
}

/// The rows of a drive's entry that differ in their unit, for prismatic or for revolute joints.
Table<DriveUnits> driveUnitKeys(const std::string& unit, const std::string& joints) {
  const std::string only = ", " + joints + " joints only";
  const DriveConfig defaults;
  return {
      number("counts_per_" + unit, "1/" + unit, within(1, kMaxCounts), "of the drive" + only,
             &DriveUnits::counts_per_unit),
      number("turns_per_" + unit, "1/" + unit, above(0, 1e4),
             "of a moteus, as it is configured" +
                 std::string(unit == "rad" ? "; absent: 1 / (2 pi)" : "") + only,
             &DriveUnits::turns_per_unit),
      number("offset_" + unit, unit, within(-1e6, 1e6),
             fmt::format("the joint's position at 0 counts; absent: {}{}", defaults.offset, only),
             &DriveUnits::offset),
      number("max_following_error_" + unit, unit, above(0, 1e3),
             fmt::format("largest distance between command and measurement; absent: {}{}",
                         defaults.max_following_error, only),
             &DriveUnits::max_following_error),
  };
}

Table<DriveConfig> driveConfigKeys() {
  using Config = DriveConfig;
  return {
      choice("kind", "what it understands: cia402 is CANopen, moteus needs CAN FD", &Config::kind,
             kDriveKindWords),
      required(integer("node_id", within(1, 127), "CANopen node id, or that of the moteus",
                       &Config::node_id)),
      integer("sign", within(-1, 1), "-1: counts fall where the joint's value rises",
              &Config::sign),
      number("tracking_gain_per_s", "1/s", within(0, 5e3),
             "pulls the drive to the commanded position; 0: not", &Config::tracking_gain_per_s),
      choice(
          "home",
          "by what a moteus has to know where it is, its register 0x00C; rotor: its joint is not "
          "moved by a turn of the rotor while it has no power",
          &Config::home, kHomeWords),
  };
}

Table<DriveSection> driveKeys() {
  using Config = DriveSection;
  const Table<Config> place = {
      text("joint", "its name in the URDF", &Config::joint),
      text("interface", "its bus, one of can.buses", &Config::interface),
  };
  const Table<Config> files = {
      text("eds", "its electronic data sheet; absent: that of all drives", &Config::eds),
      text("profile", "what it does otherwise than CiA 402 says; absent: that of all drives",
           &Config::profile),
  };
  return join(place, inside(&Config::config, driveConfigKeys()),
              inside(&Config::metres, driveUnitKeys("m", "prismatic")),
              inside(&Config::radians, driveUnitKeys("rad", "revolute")), files);
}

Table<CanTactileConfig> tareKeys() {
  using Config = CanTactileConfig;
  return {
      integer("samples", within(1, 10000), "that are averaged", &Config::tare_samples),
      number("max_offset_N", "N", above(0, 1e4), "more is a contact, or a fault",
             &Config::tare_max_offset_N),
      number("max_spread_N", "N", above(0, 1e4), "largest change of the force meanwhile",
             &Config::tare_max_spread_N),
  };
}

Table<GpioLineConfig> outputKeys() {
  return {
      required(integer("line", within(0, 65535), "offset on the chip", &GpioLineConfig::line)),
      boolean("active_low", "active is the low level", &GpioLineConfig::active_low),
  };
}

Table<GpioLineConfig> inputKeys() {
  const Table<GpioLineConfig> debounce = {
      number("debounce_s", "s", within(0, 1),
             "how long a change that lets the arm move has to last; the other acts at once",
             &GpioLineConfig::debounce_s)};
  return join(outputKeys(), debounce);
}

Row<GpioConfig> brakeSection() {
  using Config = GpioConfig;
  const Table<Config> times = {
      number("switching_s", "s", within(0, 5),
             "that the brakes take to open or to close; drives hold meanwhile",
             &Config::brake_switching_s),
  };
  return optional(group<Config>("brake", "output, active: brakes released",
                                join(inside(&Config::brake, outputKeys()), times),
                                [](Config& gpio) { gpio.brake.emplace(); }));
}

}  // namespace

Row<RobotConfig> canSection() {
  const Table<CanSection> buses = {required(sectionList(
      "buses", {1, kMaxBuses}, "buses of drives and modules", &CanSection::buses, busKeys()))};
  return section("can", "how the arm is connected; absent: it only simulates", &RobotConfig::can,
                 join(buses, inside(&CanSection::canopen, canopenKeys())));
}

Row<RobotConfig> drivesSection() {
  using Config = DrivesSection;
  return section(
      "drives", "the position-controlled drives", &RobotConfig::drives,
      {
          number("position_lag_s", "s", within(0, 1),
                 "first-order lag of the drives, bus and cycle included; 0: ideal",
                 &Config::position_lag_s),
          onlyWith(canOfTheRobot(), number("start_tolerance", "m or rad", above(0, 10),
                                           "how far a joint may be from the scene's start",
                                           &Config::start_tolerance)),
          onlyWith(canOfTheRobot(),
                   text("eds", "electronic data sheet of all drives that have none of their own",
                        &Config::eds)),
          onlyWith(canOfTheRobot(),
                   text("profile", "likewise: what they do otherwise than CiA 402 says",
                        &Config::profile)),
          onlyWith(canOfTheRobot(),
                   sectionList("joints", {1, kMaxJoints}, "one drive a moving joint",
                               &Config::joints, driveKeys())),
      });
}

Table<TactileModuleSection> moduleOnBusKeys() {
  using Config = TactileModuleSection;
  const Table<Config> interface = {
      onlyWith(canOfTheRobot(),
               text("interface", "bus of the module, one of can.buses", &Config::interface))};
  const Table<CanTactileConfig> first_id = {onlyWith(
      busOfTheModule(),
      integer("first_id", within(1, 0x7FC), "of its four frames", &CanTactileConfig::first_id))};
  const Table<Config> rest = {
      onlyWith(busOfTheModule(),
               boolean("filter_in_daemon", "the module does not filter, the daemon does",
                       &Config::filter_in_daemon)),
      onlyWith(busOfTheModule(),
               section("tare", "offset of the module, averaged in rest before the arm is activated",
                       &Config::on_bus, tareKeys())),
  };
  return join(interface, inside(&Config::on_bus, first_id), rest);
}

Row<RobotConfig> gpioSection() {
  using Config = GpioConfig;
  return onlyWith(
      canOfTheRobot(),
      section(
          "gpio", "digital lines; absent: none", &RobotConfig::gpio,
          {
              text("chip", "GPIO chip, as gpiochip0", &Config::chip),
              section("e_stop", "input, active: stop at once", &Config::e_stop, inputKeys()),
              section("enable", "input, active: the arm may move", &Config::enable, inputKeys()),
              brakeSection(),
              section("heartbeat", "output, toggles each cycle while the loop runs",
                      &Config::heartbeat, outputKeys()),
          }));
}

Row<RobotConfig> realTimeSection() {
  using Config = RealTimeConfig;
  return onlyWith(canOfTheRobot(),
                  section("real_time", "the thread of the cycle", &RobotConfig::real_time,
                          {
                              integer("priority", within(1, 98), "SCHED_FIFO", &Config::priority),
                              integer("cpu", within(-1, 1023), "core; -1: any", &Config::cpu),
                              integer("max_late_cycles", within(0, 1000),
                                      "in a row; more is a fault", &Config::max_late_cycles),
                          }));
}

}  // namespace tactus
