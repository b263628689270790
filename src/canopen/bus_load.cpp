#include "tactus/canopen/bus_load.h"

#include <algorithm>
#include <cstddef>

namespace tactus {
namespace {

constexpr int kPdoBytes = 6;        // 6040 and 60FF, 6041 and 6064
constexpr int kHeartbeatBytes = 1;  // NMT state
constexpr int kTactileBytes = 8;
constexpr int kTactileFrames = 4;

void addDrives(const HardwareConfig& hardware, int drives, double period_s, BusLoad& load) {
  const double heartbeat_s = hardware.canopen.heartbeat_period_s;
  load.terms.push_back({"RPDO1", drives, kPdoBytes, period_s});
  load.terms.push_back({"TPDO1", drives, kPdoBytes, period_s});
  load.terms.push_back({"SYNC", 1, 0, period_s});
  load.terms.push_back({"heartbeats", drives + 1, kHeartbeatBytes, heartbeat_s});
}

}  // namespace

double BusLoad::bitsPerSecond() const noexcept {
  double sum = 0.0;
  for (const BusLoadTerm& term : terms) sum += term.bitsPerSecond();
  return sum;
}

std::vector<BusLoad> busLoads(const HardwareConfig& hardware, double period_s) {
  std::vector<BusLoad> loads;
  for (std::size_t i = 0; i < hardware.buses.size(); ++i) {
    const int bus = static_cast<int>(i);
    BusLoad load{{}, hardware.buses[i].bit_rate_per_s};
    const auto drives = std::count_if(hardware.drives.begin(), hardware.drives.end(),
                                      [bus](const DriveConfig& drive) { return drive.bus == bus; });
    if (drives > 0) addDrives(hardware, static_cast<int>(drives), period_s, load);
    for (const CanTactileConfig& module : hardware.tactile_modules) {
      if (module.bus != bus) continue;
      load.terms.push_back(
          {"tactile module", kTactileFrames, kTactileBytes, module.channels.sample_period_s});
    }
    loads.push_back(load);
  }
  return loads;
}

}  // namespace tactus
