#include "tactus/io/bus_ids.h"

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/moteus_frames.h"

namespace tactus {
namespace {

constexpr std::uint32_t kStandardIds = 0x7FF;
constexpr std::uint32_t kExtendedIds = 0x1FFFFFFF;

/// A reply whose id fits into 11 bits may have either length.
void addMoteus(int node_id, BusIds& ids) {
  const std::uint32_t reply = moteusReplyId(node_id);
  ids.received.push_back({reply, kExtendedIds, true, true});
  if (reply <= kStandardIds) ids.received.push_back({reply, kStandardIds, false, true});
  ids.sent.push_back({moteusCommandId(node_id), kExtendedIds, true, true});
}

void addCanopen(int node_id, BusIds& ids) {
  const auto node = static_cast<std::uint32_t>(node_id);
  for (const std::uint32_t base :
       {cob_id::kEmergency, cob_id::kTpdo1, cob_id::kSdoAnswer, cob_id::kHeartbeat})
    ids.received.push_back({base + node});
  for (const std::uint32_t base : {cob_id::kRpdo1, cob_id::kSdoRequest})
    ids.sent.push_back({base + node});
}

}  // namespace

BusIds busIds(const HardwareConfig& hardware, int bus) {
  BusIds ids;
  bool has_canopen = false;
  for (const DriveConfig& drive : hardware.drives) {
    if (drive.bus != bus) continue;
    has_canopen = has_canopen || drive.kind == DriveKind::kCia402;
    if (drive.kind == DriveKind::kMoteus)
      addMoteus(drive.node_id, ids);
    else
      addCanopen(drive.node_id, ids);
  }
  if (has_canopen) {
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
