#pragma once

#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"

/// The two process data objects of a drive as the set-up maps them (see drive_setup.h), six bytes
/// each.
namespace tactus {

/// RPDO1, to the drive: 6040:00, 60FF:00.
struct DriveCommand {
  std::uint16_t control_word = 0;
  std::int32_t velocity = 0;  ///< counts/s

  bool operator==(const DriveCommand&) const = default;
};

/// TPDO1, from the drive: 6041:00, 6064:00.
struct DriveFeedback {
  std::uint16_t status_word = 0;
  std::int32_t position = 0;  ///< counts

  bool operator==(const DriveFeedback&) const = default;
};

CanFrame commandFrame(int node_id, const DriveCommand& command) noexcept;
/// Nothing if the frame is not that of this node, or not six bytes long.
std::optional<DriveFeedback> decodeFeedback(const CanFrame& frame, int node_id) noexcept;

}  // namespace tactus
