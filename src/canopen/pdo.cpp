#include "tactus/canopen/pdo.h"

#include "tactus/canopen/canopen.h"

namespace tactus {

CanFrame commandFrame(int node_id, const DriveCommand& command) noexcept {
  CanFrame frame;
  frame.id = cob_id::kRpdo1 + static_cast<std::uint32_t>(node_id);
  frame.size = 6;
  writeLittleEndian(frame, 0, 2, command.control_word);
  writeLittleEndian(frame, 2, 4, static_cast<std::uint32_t>(command.velocity));
  return frame;
}

std::optional<DriveFeedback> decodeFeedback(const CanFrame& frame, int node_id) noexcept {
  if (!isDataFrame(frame, cob_id::kTpdo1 + static_cast<std::uint32_t>(node_id), 6))
    return std::nullopt;
  return DriveFeedback{static_cast<std::uint16_t>(readLittleEndian(frame, 0, 2)),
                       static_cast<std::int32_t>(readLittleEndian(frame, 2, 4))};
}

}  // namespace tactus
