#include "tactus/scene/hardware_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/moteus_frames.h"
#include "tactus/scene/drive_loader.h"
#include "tactus/scene/tactile_loader.h"

namespace tactus {
namespace {

/// A name that the kernel gives a device: no slash, no white space.
bool isDeviceName(std::string_view name, std::size_t max_size) {
  const auto is_allowed = [](char c) { return c > ' ' && c < 0x7F && c != '/' && c != ':'; };
  return name.size() <= max_size && std::ranges::all_of(name, is_allowed) && name != "." &&
         name != "..";
}

void checkBuses(const LoadingRobot& l) {
  constexpr std::size_t kMaxInterfaceName = 15;  // IFNAMSIZ with its end
  const std::vector<BusConfig>& buses = l.can.buses;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const std::string& name = buses[i].interface;
    const std::string path = fmt::format("can.buses[{}].interface", i);
    if (!isDeviceName(name, kMaxInterfaceName)) {
      l.fail(path, inQuotes(name) + " is no name of a network interface",
             fmt::format("1 to {} letters and digits, as can0", kMaxInterfaceName));
    }
    if (std::ranges::find(buses, name, &BusConfig::interface) != buses.begin() + i) {
      l.fail(path, inQuotes(name) + " is given twice", "each bus once");
    }
    if (buses[i].data_bit_rate_per_s.value_or(HUGE_VAL) < buses[i].bit_rate_per_s) {
      l.fail(fmt::format("can.buses[{}].data_bit_rate_per_s", i),
             fmt::format("{} is less than the bit rate", *buses[i].data_bit_rate_per_s),
             fmt::format("at least bit_rate_per_s = {}", buses[i].bit_rate_per_s));
    }
  }
}

void checkHeartbeat(const LoadingRobot& l) {
  const CanopenConfig& canopen = l.can.canopen;
  constexpr double kTolerance = 1e-6;
  const auto checkMilliseconds = [&](const char* key, double seconds) {
    if (std::abs(seconds * 1e3 - std::round(seconds * 1e3)) <= kTolerance) return;
    l.fail(key, fmt::format("{} s is no whole number of milliseconds", seconds),
           "what CANopen can say");
  };
  checkMilliseconds("can.heartbeat_period_s", canopen.heartbeat_period_s);
  checkMilliseconds("can.heartbeat_timeout_s", canopen.heartbeat_timeout_s);
  const double least_s = 2.0 * canopen.heartbeat_period_s;
  if (canopen.heartbeat_timeout_s < least_s - 1e-3 * kTolerance) {
    l.fail(
        "can.heartbeat_timeout_s",
        fmt::format("{} s has no room for a heartbeat that is late", canopen.heartbeat_timeout_s),
        fmt::format("at least twice heartbeat_period_s, {:g}", least_s));
  }
}

/// An id of CiA 301 that is in use on a bus.
struct UsedId {
  std::uint32_t id;
  std::string name;
};

std::vector<UsedId> usedIds(const HardwareConfig& hardware, int bus) {
  std::vector<UsedId> ids;
  for (const DriveConfig& drive : hardware.drives) {
    if (drive.bus != bus) continue;
    const auto add = [&](std::uint32_t base, const char* name) {
      ids.push_back({base + drive.node_id, fmt::format("{} of node {}", name, drive.node_id)});
    };
    if (drive.kind == DriveKind::kMoteus) {
      ids.push_back(
          {moteusReplyId(drive.node_id), fmt::format("reply of moteus {}", drive.node_id)});
      continue;
    }
    add(cob_id::kEmergency, "EMCY");
    add(cob_id::kTpdo1, "TPDO1");
    add(cob_id::kRpdo1, "RPDO1");
    add(cob_id::kSdoAnswer, "SDO answer");
    add(cob_id::kSdoRequest, "SDO request");
    add(cob_id::kHeartbeat, "heartbeat");
  }
  if (ids.empty()) return ids;
  ids.push_back({cob_id::kSync, "SYNC"});
  ids.push_back({cob_id::kHeartbeat + hardware.canopen.master_node_id, "heartbeat of the master"});
  return ids;
}

/// Frames of the modules before this one on its bus.
std::vector<UsedId> moduleIds(const HardwareConfig& hardware, std::size_t before, int bus) {
  std::vector<UsedId> ids;
  for (std::size_t i = 0; i < before; ++i) {
    const CanTactileConfig& module = hardware.tactile_modules[i];
    if (module.bus != bus) continue;
    for (std::uint32_t k = 0; k < 4; ++k)
      ids.push_back({module.first_id + k, fmt::format("frame {} of tactile_modules[{}]", k, i)});
  }
  return ids;
}

/// Hazard: a moteus takes what a module says for commands, as of its mode.
void checkAddress(const LoadingRobot& l, const DriveConfig& moteus, const CanTactileConfig& module,
                  const std::string& path) {
  for (std::uint32_t id = module.first_id; id < module.first_id + 4; ++id) {
    const int address = moteusAddressOf(id);
    if (address != moteus.node_id && address != kEveryMoteus) continue;
    l.fail(path,
           fmt::format("frame {:#05x} is one to moteus {} on the same bus", id, moteus.node_id),
           "four ids whose low bytes are neither its node_id nor 127");
  }
}

void checkModuleIds(const LoadingRobot& l, const HardwareConfig& hardware, std::size_t index) {
  const CanTactileConfig& module = hardware.tactile_modules[index];
  std::vector<UsedId> ids = usedIds(hardware, module.bus);
  for (UsedId& used : moduleIds(hardware, index, module.bus)) ids.push_back(std::move(used));
  for (const UsedId& used : ids) {
    if (used.id < module.first_id || used.id > module.first_id + 3) continue;
    l.fail(moduleKey(l.root, index) + ".first_id",
           fmt::format("frame {:#05x} is the {} on the same bus", used.id, used.name),
           "four ids of its own");
  }
  for (const DriveConfig& drive : hardware.drives) {
    if (drive.kind == DriveKind::kMoteus && drive.bus == module.bus)
      checkAddress(l, drive, module, moduleKey(l.root, index) + ".first_id");
  }
}

CanTactileConfig makeModule(const LoadingRobot& l, std::size_t index) {
  const TactileModuleSection& module = l.config.tactile_modules[index];
  const std::string key = moduleKey(l.root, index);
  const std::string path = key + ".interface";
  if (!module.interface) l.fail(path, "is missing", "one of " + listOfBuses(l));
  CanTactileConfig config = module.on_bus;
  config.bus = findBus(l, *module.interface, path);
  config.channels = module.channels;
  if (!module.filter_in_daemon) return config;
  const double cutoff_hz = module.config.filter_cutoff_hz;
  const double sample_period_s = module.channels.sample_period_s;
  config.filter_cutoff_hz = cutoff_hz;
  if (cutoff_hz * sample_period_s >= 0.5) {
    l.fail(key + ".filter_cutoff_hz",
           fmt::format("{} Hz is too high for a filter in the daemon", cutoff_hz),
           fmt::format("less than half the samples' rate of {} Hz", 1.0 / sample_period_s));
  }
  return config;
}

void checkLines(const LoadingRobot& l, const GpioConfig& gpio) {
  constexpr std::size_t kMaxChipName = 31;
  if (!isDeviceName(gpio.chip, kMaxChipName)) {
    l.fail("gpio.chip", inQuotes(gpio.chip) + " is no name of a GPIO chip", "one as gpiochip0");
  }
  std::vector<std::pair<int, const char*>> lines;
  const auto check = [&](const std::optional<GpioLineConfig>& line, const char* key) {
    if (!line) return;
    for (const auto& [number, owner] : lines) {
      if (number != line->line) continue;
      l.fail(fmt::format("gpio.{}.line", key), fmt::format("line {} is {}'s", number, owner),
             "a line of its own");
    }
    lines.emplace_back(line->line, key);
  };
  check(gpio.e_stop, "e_stop");
  check(gpio.enable, "enable");
  check(gpio.brake, "brake");
  check(gpio.heartbeat, "heartbeat");
  if (lines.empty()) {
    l.fail("gpio", "no line", "one of e_stop, enable, brake, heartbeat, or no section");
  }
}

bool isUsed(const HardwareConfig& hardware, int bus) {
  return std::ranges::count(hardware.drives, bus, &DriveConfig::bus) > 0 ||
         std::ranges::count(hardware.tactile_modules, bus, &CanTactileConfig::bus) > 0;
}

}  // namespace

std::optional<HardwareConfig> loadHardware(const YamlNode& root, const RobotConfig& config,
                                           const UrdfChain& chain,
                                           const std::vector<DriveSheet>& sheets) {
  if (!config.can) return std::nullopt;
  const LoadingRobot l{root, config, *config.can, chain, sheets};
  checkBuses(l);
  checkHeartbeat(l);
  HardwareConfig hardware{.buses = l.can.buses,
                          .drives = loadDrives(l),
                          .canopen = l.can.canopen,
                          .tactile_modules = {},
                          .gpio = config.gpio,
                          .real_time = config.real_time,
                          .start_tolerance = config.drives.start_tolerance};
  for (std::size_t i = 0; i < config.tactile_modules.size(); ++i) {
    hardware.tactile_modules.push_back(makeModule(l, i));
    checkModuleIds(l, hardware, i);
  }
  for (std::size_t i = 0; i < l.can.buses.size(); ++i) {
    if (isUsed(hardware, static_cast<int>(i))) continue;
    l.fail(fmt::format("can.buses[{}]", i), "nothing is on " + inQuotes(l.can.buses[i].interface),
           "a drive or a tactile module, or no such bus");
  }
  if (hardware.gpio) checkLines(l, *hardware.gpio);
  return hardware;
}

HardwareConfig withoutTactileModules(const HardwareConfig& hardware) {
  HardwareConfig result = hardware;
  result.tactile_modules.clear();
  result.buses.clear();
  for (std::size_t i = 0; i < hardware.buses.size(); ++i) {
    const int old_bus = static_cast<int>(i);
    if (std::ranges::count(hardware.drives, old_bus, &DriveConfig::bus) == 0) continue;
    for (std::size_t k = 0; k < hardware.drives.size(); ++k) {
      if (hardware.drives[k].bus == old_bus) {
        result.drives[k].bus = static_cast<int>(result.buses.size());
      }
    }
    result.buses.push_back(hardware.buses[i]);
  }
  return result;
}

}  // namespace tactus
