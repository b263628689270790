#include "tactus/io/bus_ids.h"

#include "tactus/canopen/canopen.h"

namespace tactus {

BusIds busIds(const HardwareConfig& hardware, int bus) {
  BusIds ids;
  for (const DriveConfig& drive : hardware.drives) {
    if (drive.bus != bus) continue;
    const auto node = static_cast<std::uint32_t>(drive.node_id);
    for (const std::uint32_t base :
         {cob_id::kEmergency, cob_id::kTpdo1, cob_id::kSdoAnswer, cob_id::kHeartbeat})
      ids.received.push_back({base + node});
    for (const std::uint32_t base : {cob_id::kRpdo1, cob_id::kSdoRequest})
      ids.sent.push_back({base + node});
  }
  if (!ids.sent.empty()) {
    for (const std::uint32_t id : {cob_id::kNmt, cob_id::kSync}) ids.sent.push_back({id});
  }
  // Also where only a module is: to probe a bus that was down.
  const auto master = static_cast<std::uint32_t>(hardware.canopen.master_node_id);
  ids.sent.push_back({cob_id::kHeartbeat + master});
  for (const CanTactileConfig& module : hardware.tactile_modules) {
    if (module.bus != bus) continue;
    for (std::uint32_t k = 0; k < 4; ++k) ids.received.push_back({module.first_id + k});
  }
  return ids;
}

}  // namespace tactus
