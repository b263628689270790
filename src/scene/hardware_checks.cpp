#include "tactus/scene/hardware_checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/canopen/drive_setup.h"
#include "tactus/scene/bus_load_text.h"
#include "tactus/scene/eds_check.h"
#include "tactus/scene/scene_checks.h"

namespace tactus {
namespace {

void checkCycle(const YamlNode& scene, double period_s) {
  if (interpolationPeriod(period_s)) return;
  failAt(locate(scene, "period_s"), "period_s",
         fmt::format("drives cannot be told of {} s", period_s),
         "expected 1 to 255 times a power of ten of seconds (object 60C2), as 0.001 or 0.00125");
}

void checkHeartbeat(const YamlNode& root, double period_s, const CanSection& can) {
  const char* const key = "can.heartbeat_period_s";
  const double heartbeat_s = can.canopen.heartbeat_period_s;
  if (heartbeat_s >= period_s) return;
  failAt(locate(root, key), key, fmt::format("{} s is shorter than a cycle", heartbeat_s),
         fmt::format("expected at least the scene's period_s = {}", period_s));
}

/// A drive's status is some cycles old: no drive can be seen off sooner.
void checkStopDeadline(const YamlNode& root, double period_s, const CanSection& can) {
  constexpr double kLeastCycles = 10.0;
  constexpr double kRounding_s = 1e-9;
  const char* const key = "can.stop_deadline_s";
  const double deadline_s = can.canopen.stop_deadline_s;
  if (deadline_s >= kLeastCycles * period_s - kRounding_s) return;
  failAt(locate(root, key), key, fmt::format("{} s is shorter than ten cycles", deadline_s),
         fmt::format("expected at least {:g} s, and longer than the longest quick stop",
                     kLeastCycles * period_s));
}

/// K (q_d - q) is a loop of its own, whose delay is the drive's lag and the two cycles in which the
/// feedback of one comes back as a setpoint: up to a quarter of 1 / delay it does not swing.
void checkTrackingGains(const YamlNode& root, double period_s, const DrivesSection& drives) {
  const double most_per_s = 0.25 / (drives.position_lag_s + 2.0 * period_s);
  for (std::size_t i = 0; i < drives.joints.size(); ++i) {
    const double gain_per_s = drives.joints[i].config.tracking_gain_per_s;
    if (gain_per_s <= most_per_s) continue;
    const std::string key = fmt::format("drives.joints[{}].tracking_gain_per_s", i);
    failAt(
        locate(root, key), key, fmt::format("{} is too high", gain_per_s),
        fmt::format("expected at most 1 / (4 (position_lag_s + 2 period_s)) = {:.4g}", most_per_s));
  }
}

bool isOverloaded(const BusLoad& load) {
  constexpr double kRounding = 1e-9;
  return load.share() > kMaxBusLoad + kRounding;
}

bool hasTooManyFrames(const BusLoad& load, double period_s) {
  return load.framesACycle(period_s) > kMaxFramesACycle;
}

/// How a bus is relieved: by the shortest cycle that overloads none and fits all else, or by other
/// means where there is no such cycle.
std::string cureOfOverload(double period_s, const RobotConfig& config,
                           const HardwareConfig& hardware) {
  constexpr int kStepsPerSecond = 100000;
  constexpr int kMaxSteps = 2000;  // 0.02 s, the longest cycle
  const auto fitsModules = [&](double longer_s) {
    const auto fits = [longer_s](const TactileModuleSection& module) {
      return fitsModule(longer_s, module.simulated.filter_rate_hz);
    };
    return hardware.tactile_modules.empty() || std::ranges::all_of(config.tactile_modules, fits);
  };
  for (int steps = static_cast<int>(period_s * kStepsPerSecond); steps <= kMaxSteps; ++steps) {
    const double longer_s = static_cast<double>(steps) / kStepsPerSecond;
    if (longer_s <= period_s || longer_s > hardware.canopen.heartbeat_period_s ||
        !interpolationPeriod(longer_s) || !fitsModules(longer_s) ||
        std::ranges::any_of(busLoads(hardware, longer_s), [longer_s](const BusLoad& load) {
          return isOverloaded(load) || hasTooManyFrames(load, longer_s);
        }))
      continue;
    return fmt::format("a period_s of at least {}", longer_s);
  }
  return "less on this bus: fewer drives or modules, or fewer samples a second";
}

void checkBusLoads(const YamlNode& root, double period_s, const RobotConfig& config,
                   const HardwareConfig& hardware) {
  const std::vector<BusLoad> loads = busLoads(hardware, period_s);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const std::string& interface = hardware.buses[i].interface;
    const auto given = std::ranges::find(config.can->buses, interface, &BusConfig::interface);
    const std::string key = fmt::format("can.buses[{}]", given - config.can->buses.begin());
    if (isOverloaded(loads[i]))
      failAt(locate(root, key), key,
             fmt::format("{} is overloaded: {}", interface, describeBusLoad(loads[i], period_s)),
             fmt::format("expected at most {:.4g} %: {}", 100.0 * kMaxBusLoad,
                         cureOfOverload(period_s, config, hardware)));
    if (hasTooManyFrames(loads[i], period_s))
      failAt(locate(root, key), key,
             fmt::format("{} has up to {} frames a cycle: {}", interface,
                         loads[i].framesACycle(period_s), describeBusLoad(loads[i], period_s)),
             fmt::format("expected at most {}: a shorter period_s, or less on this bus",
                         kMaxFramesACycle));
  }
}

void checkSheets(const LoadedRobot& robot, double period_s, const HardwareConfig& hardware) {
  for (std::size_t i = 0; i < robot.sheets.size(); ++i) {
    if (!robot.sheets[i].eds) continue;
    const auto joint =
        std::ranges::find(robot.chain.joint_names, robot.config.drives.joints[i].joint);
    const DriveConfig& drive = hardware.drives[joint - robot.chain.joint_names.begin()];
    checkEds(*robot.sheets[i].eds, drive, hardware.buses[drive.bus], hardware.canopen, period_s);
  }
}

}  // namespace

void checkHardware(const YamlNode& scene, const LoadedRobot& robot, double period_s,
                   const HardwareConfig& hardware) {
  const RobotConfig& config = robot.config;
  checkCycle(scene, period_s);
  checkHeartbeat(robot.root, period_s, *config.can);
  checkStopDeadline(robot.root, period_s, *config.can);
  checkTrackingGains(robot.root, period_s, config.drives);
  checkSheets(robot, period_s, hardware);
  checkBusLoads(robot.root, period_s, config, hardware);
}

}  // namespace tactus
