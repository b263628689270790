#include "tactus/scene/key_builders.h"

namespace tactus {
namespace {

using namespace keys;
using Draft = ConfigDraft;

// CANopen counts these times in 16 bits of milliseconds.
constexpr double kMaxHeartbeat_s = 65.535;
constexpr double kMaxCounts = 1e9;  // a unit or s; more does not fit into INTEGER32 anyway

BusConfig& bus(Draft& d) { return d.buses.back(); }
DriveDraft& drive(Draft& d) { return d.drives.back(); }

std::vector<KeySpec> busKeys() {
  return {
      text("interface", "CAN network interface",
           [](Draft& d) -> std::string& { return bus(d).interface; }),
      defaulted("1e6", number("bit_rate_per_s", "1/s", within(10e3, 1e6), "of the bus",
                              [](Draft& d) -> double& { return bus(d).bit_rate_per_s; })),
  };
}

std::vector<KeySpec> canopenKeys() {
  return {
      defaulted("127", integer("master_node_id", within(1, 127), "node id of the daemon",
                               [](Draft& d) -> int& { return d.canopen.master_node_id; })),
      defaulted("0.02", number("heartbeat_period_s", "s", within(0.001, kMaxHeartbeat_s),
                               "of daemon and drives, whole milliseconds",
                               [](Draft& d) -> double& { return d.canopen.heartbeat_period_s; })),
      defaulted("0.06", number("heartbeat_timeout_s", "s", within(0.001, kMaxHeartbeat_s),
                               "silence after which the other side is taken for dead, and a drive "
                               "with object 1400:05 misses its setpoints, whole milliseconds",
                               [](Draft& d) -> double& { return d.canopen.heartbeat_timeout_s; })),
      defaulted("0.1", number("sdo_timeout_s", "s", within(0.001, 10),
                              "for a drive to answer while it is configured",
                              [](Draft& d) -> double& { return d.canopen.sdo_timeout_s; })),
      defaulted("5",
                number("boot_timeout_s", "s", within(0.1, 600), "for all drives to be configured",
                       [](Draft& d) -> double& { return d.canopen.boot_timeout_s; })),
  };
}

/// The rows of a drive's entry that differ in their unit, for prismatic or for revolute joints.
template <DriveUnits DriveDraft::*kUnits>
std::vector<KeySpec> driveUnitKeys(const std::string& unit, const std::string& joints) {
  const std::string only = ", " + joints + " joints only";
  return {
      optional(number("counts_per_" + unit, "1/" + unit, within(1, kMaxCounts),
                      "of the drive" + only,
                      [](Draft& d) -> double& { return (drive(d).*kUnits).counts_per_unit; })),
      optional(number("offset_" + unit, unit, within(-1e6, 1e6),
                      "the joint's position at 0 counts; absent: 0" + only,
                      [](Draft& d) -> double& { return (drive(d).*kUnits).offset; })),
      optional(number("max_following_error_" + unit, unit, above(0, 1e3),
                      "largest distance between command and measurement; absent: 0.05" + only,
                      [](Draft& d) -> double& { return (drive(d).*kUnits).max_following_error; })),
  };
}

std::vector<KeySpec> driveKeys() {
  std::vector<KeySpec> rows = {
      text("joint", "its name in the URDF",
           [](Draft& d) -> std::string& { return drive(d).joint; }),
      text("interface", "its bus, one of can.buses",
           [](Draft& d) -> std::string& { return drive(d).interface; }),
      integer("node_id", within(1, 127), "CANopen node id",
              [](Draft& d) -> int& { return drive(d).config.node_id; }),
      defaulted("1", integer("sign", within(-1, 1), "-1: counts fall where the joint's value rises",
                             [](Draft& d) -> int& { return drive(d).config.sign; })),
      defaulted("0",
                number("tracking_gain_per_s", "1/s", within(0, 5e3),
                       "pulls the drive to the commanded position; 0: not",
                       [](Draft& d) -> double& { return drive(d).config.tracking_gain_per_s; })),
  };
  for (const KeySpec& row : driveUnitKeys<&DriveDraft::metres>("m", "prismatic")) {
    rows.push_back(row);
  }
  for (const KeySpec& row : driveUnitKeys<&DriveDraft::radians>("rad", "revolute")) {
    rows.push_back(row);
  }
  return rows;
}

KeySpec tareSection() {
  return section(
      "tare", "offset of the module, averaged in rest before the arm is activated",
      {
          defaulted("50", integer("samples", within(1, 10000), "that are averaged",
                                  [](Draft& d) -> int& { return d.can_tactile.tare_samples; })),
          defaulted("2",
                    number("max_offset_N", "N", above(0, 1e4), "more is a contact, or a fault",
                           [](Draft& d) -> double& { return d.can_tactile.tare_max_offset_N; })),
          defaulted(
              "0.2",
              number("max_spread_N", "N", above(0, 1e4), "largest change of the force meanwhile",
                     [](Draft& d) -> double& { return d.can_tactile.tare_max_spread_N; })),
      });
}

KeySpec lineNumber(int& (*target)(Draft&)) {
  return integer("line", within(0, 65535), "offset on the chip", target);
}

KeySpec activeLow(bool& (*target)(Draft&)) {
  return defaulted("false", boolean("active_low", "active is the low level", target));
}

template <std::optional<GpioLineConfig> GpioConfig::*kLine>
KeySpec outputSection(const std::string& key, const std::string& doc) {
  return optional(
      section(key, doc,
              {
                  lineNumber([](Draft& d) -> int& { return ((*d.gpio).*kLine)->line; }),
                  activeLow([](Draft& d) -> bool& { return ((*d.gpio).*kLine)->active_low; }),
              },
              [](Draft& d) { ((*d.gpio).*kLine).emplace(); }));
}

template <std::optional<GpioLineConfig> GpioConfig::*kLine>
KeySpec inputSection(const std::string& key, const std::string& doc) {
  KeySpec spec = outputSection<kLine>(key, doc);
  spec.keys.push_back(defaulted(
      "0", number("debounce_s", "s", within(0, 1),
                  "how long a change that lets the arm move has to last; the other acts at once",
                  [](Draft& d) -> double& { return ((*d.gpio).*kLine)->debounce_s; })));
  return spec;
}

KeySpec brakeSection() {
  KeySpec spec = outputSection<&GpioConfig::brake>("brake", "output, active: brakes released");
  spec.keys.push_back(
      defaulted("0.1", number("switching_s", "s", within(0, 5),
                              "that the brakes take to open or to close; drives hold meanwhile",
                              [](Draft& d) -> double& { return d.gpio->brake_switching_s; })));
  spec.keys.push_back(defaulted(
      "0.5", number("deadline_s", "s", above(0, 60),
                    "after a fault, longer than the longest quick stop: brakes are closed by then, "
                    "and drives not seen off are cut off from the bus",
                    [](Draft& d) -> double& { return d.gpio->brake_deadline_s; })));
  return spec;
}

}  // namespace

KeySpec canSection() {
  std::vector<KeySpec> rows = {sectionList("buses", {1, kMaxBuses}, "buses of drives and module",
                                           busKeys(), [](Draft& d) { d.buses.emplace_back(); })};
  for (const KeySpec& row : canopenKeys()) rows.push_back(row);
  return section("can", "how the arm is connected; absent: it only simulates", rows);
}

KeySpec drivesSection() {
  return section(
      "drives", "the position-controlled drives",
      {
          defaulted("0.005", number("position_lag_s", "s", within(0, 1),
                                    "first-order lag of the simulated drives; 0: ideal",
                                    [](Draft& d) -> double& { return d.plant.drive_lag_s; })),
          defaulted("0.02", number("start_tolerance", "m or rad", above(0, 10),
                                   "how far a joint may be from the scene's start",
                                   [](Draft& d) -> double& { return d.start_tolerance; })),
          optional(sectionList("joints", {1, kMaxJoints}, "one CiA 402 drive a moving joint",
                               driveKeys(), [](Draft& d) { d.drives.emplace_back(); })),
      });
}

std::vector<KeySpec> moduleOnBusKeys() {
  return {
      optional(text("interface", "bus of the module, one of can.buses",
                    [](Draft& d) -> std::string& { return d.module_interface; })),
      defaulted("0x100", integer("first_id", within(1, 0x7FC), "of its four frames",
                                 [](Draft& d) -> int& { return d.module_first_id; })),
      defaulted("false", boolean("filter_in_daemon", "the module does not filter, the daemon does",
                                 [](Draft& d) -> bool& { return d.filter_in_daemon; })),
      defaulted("", tareSection()),
  };
}

KeySpec gpioSection() {
  return section("gpio", "digital lines; absent: none",
                 {
                     text("chip", "GPIO chip, as gpiochip0",
                          [](Draft& d) -> std::string& { return d.gpio->chip; }),
                     inputSection<&GpioConfig::e_stop>("e_stop", "input, active: stop at once"),
                     inputSection<&GpioConfig::enable>("enable", "input, active: the arm may move"),
                     brakeSection(),
                     outputSection<&GpioConfig::heartbeat>(
                         "heartbeat", "output, toggles each cycle while the loop runs"),
                 },
                 [](Draft& d) { d.gpio.emplace(); });
}

KeySpec realTimeSection() {
  return section(
      "real_time", "the thread of the cycle",
      {
          defaulted("80", integer("priority", within(1, 98), "SCHED_FIFO",
                                  [](Draft& d) -> int& { return d.real_time.priority; })),
          defaulted("-1", integer("cpu", within(-1, 1023), "core; -1: any",
                                  [](Draft& d) -> int& { return d.real_time.cpu; })),
          defaulted("3", integer("max_late_cycles", within(0, 1000), "in a row; more is a fault",
                                 [](Draft& d) -> int& { return d.real_time.max_late_cycles; })),
      });
}

}  // namespace tactus
