#include "tactus/scene/hardware_checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/canopen/drive_setup.h"
#include "tactus/scene/bus_load_text.h"

namespace tactus {
namespace {

void checkCycle(const YamlNode& scene, const ConfigDraft& draft) {
  if (interpolationPeriod(draft.period_s)) return;
  failAt(locate(scene, "period_s"), "period_s",
         fmt::format("drives cannot be told of {} s", draft.period_s),
         "expected 1 to 255 times a power of ten of seconds (object 60C2), as 0.001 or 0.00125");
}

void checkHeartbeat(const YamlNode& root, const ConfigDraft& draft) {
  const char* const key = "can.heartbeat_period_s";
  const double heartbeat_s = draft.canopen.heartbeat_period_s;
  if (heartbeat_s >= draft.period_s) return;
  failAt(locate(root, key), key, fmt::format("{} s is shorter than a cycle", heartbeat_s),
         fmt::format("expected at least the scene's period_s = {}", draft.period_s));
}

/// A measured position answers a setpoint two cycles later: with more, the loop overshoots.
void checkTrackingGains(const YamlNode& root, const ConfigDraft& draft) {
  constexpr double kMaxStep = 0.5;
  for (std::size_t i = 0; i < draft.drives.size(); ++i) {
    const double gain_per_s = draft.drives[i].config.tracking_gain_per_s;
    if (gain_per_s * draft.period_s <= kMaxStep) continue;
    const std::string key = fmt::format("drives.joints[{}].tracking_gain_per_s", i);
    failAt(locate(root, key), key, fmt::format("{} is too high", gain_per_s),
           fmt::format("expected at most {} / period_s = {}", kMaxStep, kMaxStep / draft.period_s));
  }
}

void checkBusLoads(const YamlNode& root, const ConfigDraft& draft, const HardwareConfig& hardware) {
  constexpr double kRounding = 1e-9;
  const std::vector<BusLoad> loads = busLoads(hardware, draft.period_s);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if (loads[i].share() <= kMaxBusLoad + kRounding) continue;
    const std::string& interface = hardware.buses[i].interface;
    const auto given = std::ranges::find(draft.buses, interface, &BusConfig::interface);
    const std::string key = fmt::format("can.buses[{}]", given - draft.buses.begin());
    failAt(
        locate(root, key), key,
        fmt::format("{} is overloaded: {}", interface, describeBusLoad(loads[i], draft.period_s)),
        fmt::format("expected at most {:.4g} %", 100.0 * kMaxBusLoad));
  }
}

}  // namespace

void checkHardware(const YamlNode& scene, const YamlNode& robot, const ConfigDraft& draft,
                   const HardwareConfig& hardware) {
  checkCycle(scene, draft);
  checkHeartbeat(robot, draft);
  checkTrackingGains(robot, draft);
  checkBusLoads(robot, draft, hardware);
}

}  // namespace tactus
