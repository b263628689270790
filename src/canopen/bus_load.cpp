#include "tactus/canopen/bus_load.h"

#include <algorithm>
#include <cstddef>

#include "tactus/canopen/moteus_frames.h"

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

/// Each of them in turn is told, and replies: 29-bit ids at worst.
void addMoteus(const BusConfig& bus, int drives, double period_s, BusLoad& load) {
  const FdTiming fd{bus.data_bit_rate_per_s.value_or(bus.bit_rate_per_s) / bus.bit_rate_per_s,
                    true};
  load.terms.push_back({"moteus command", drives, kMoteusCommandBytes, period_s, fd});
  load.terms.push_back({"moteus reply", drives, kMoteusReplyBytes, period_s, fd});
}

int drivesOn(const HardwareConfig& hardware, int bus, DriveKind kind) {
  return static_cast<int>(std::count_if(
      hardware.drives.begin(), hardware.drives.end(),
      [&](const DriveConfig& drive) { return drive.bus == bus && drive.kind == kind; }));
}

}  // namespace

double BusLoad::bitsPerSecond() const noexcept {
  double sum = 0.0;
  for (const BusLoadTerm& term : terms) sum += term.bitsPerSecond();
  return sum;
}

int BusLoad::framesACycle(double cycle_s) const noexcept {
  int sum = 0;
  for (const BusLoadTerm& term : terms) sum += term.framesACycle(cycle_s);
  return sum;
}

std::vector<BusLoad> busLoads(const HardwareConfig& hardware, double period_s) {
  std::vector<BusLoad> loads;
  for (std::size_t i = 0; i < hardware.buses.size(); ++i) {
    const int bus = static_cast<int>(i);
    BusLoad load{{}, hardware.buses[i].bit_rate_per_s};
    const int drives = drivesOn(hardware, bus, DriveKind::kCia402);
    if (drives > 0) addDrives(hardware, drives, period_s, load);
    const int moteus = drivesOn(hardware, bus, DriveKind::kMoteus);
    if (moteus > 0) addMoteus(hardware.buses[i], moteus, period_s, load);
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
