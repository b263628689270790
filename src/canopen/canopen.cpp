#include "tactus/canopen/canopen.h"

namespace tactus {
namespace {

CanFrame frameOf(std::uint32_t id, std::uint8_t size) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.size = size;
  return frame;
}

std::uint32_t idOf(std::uint32_t base, int node_id) noexcept {
  return base + static_cast<std::uint32_t>(node_id);
}

}  // namespace

bool isDataFrame(const CanFrame& frame, std::uint32_t id, std::uint8_t size) noexcept {
  return frame.kind == FrameKind::kData && !frame.extended && !frame.is_fd && frame.id == id &&
         frame.size == size;
}

std::uint32_t readLittleEndian(const CanFrame& frame, int offset, int size) noexcept {
  std::uint32_t value = 0;
  for (int i = 0; i < size; ++i) value |= std::uint32_t{frame.data[offset + i]} << (8 * i);
  return value;
}

void writeLittleEndian(CanFrame& frame, int offset, int size, std::uint32_t value) noexcept {
  for (int i = 0; i < size; ++i)
    frame.data[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

CanFrame nmtFrame(const NmtMessage& message) noexcept {
  CanFrame frame = frameOf(cob_id::kNmt, 2);
  frame.data[0] = static_cast<std::uint8_t>(message.command);
  frame.data[1] = static_cast<std::uint8_t>(message.node_id);
  return frame;
}

std::optional<NmtMessage> decodeNmt(const CanFrame& frame) noexcept {
  if (!isDataFrame(frame, cob_id::kNmt, 2) || frame.data[1] > kMaxNodeId) return std::nullopt;
  const auto command = static_cast<NmtCommand>(frame.data[0]);
  switch (command) {
    case NmtCommand::kStart:
    case NmtCommand::kStop:
    case NmtCommand::kEnterPreOperational:
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      return NmtMessage{command, frame.data[1]};
  }
  return std::nullopt;
}

CanFrame syncFrame() noexcept { return frameOf(cob_id::kSync, 0); }

CanFrame heartbeatFrame(int node_id, NmtState state) noexcept {
  CanFrame frame = frameOf(idOf(cob_id::kHeartbeat, node_id), 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

std::optional<NmtState> decodeHeartbeat(const CanFrame& frame, int node_id) noexcept {
  if (!isDataFrame(frame, idOf(cob_id::kHeartbeat, node_id), 1)) return std::nullopt;
  const auto state = static_cast<NmtState>(frame.data[0]);
  switch (state) {
    case NmtState::kBootUp:
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational:
      return state;
  }
  return std::nullopt;
}

CanFrame emergencyFrame(int node_id, const Emergency& emergency) noexcept {
  CanFrame frame = frameOf(idOf(cob_id::kEmergency, node_id), 8);
  writeLittleEndian(frame, 0, 2, emergency.code);
  frame.data[2] = emergency.error_register;
  return frame;
}

std::optional<Emergency> decodeEmergency(const CanFrame& frame, int node_id) noexcept {
  if (!isDataFrame(frame, idOf(cob_id::kEmergency, node_id), 8)) return std::nullopt;
  return Emergency{static_cast<std::uint16_t>(readLittleEndian(frame, 0, 2)), frame.data[2]};
}

}  // namespace tactus
