#include "tactus/io/kernel_frame.h"

#include <algorithm>
#include <cstring>
#include <system_error>

namespace tactus {

CanFrame fromKernel(const can_frame& raw) noexcept {
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if ((raw.can_id & CAN_RTR_FLAG) != 0) frame.kind = FrameKind::kRemote;
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    frame.kind = FrameKind::kError;
    frame.id = raw.can_id & CAN_ERR_MASK;
  }
  frame.size = std::min<std::uint8_t>(raw.len, CAN_MAX_DLEN);
  std::copy_n(raw.data, CAN_MAX_DLEN, frame.data.begin());
  return frame;
}

can_frame toKernel(const CanFrame& frame) noexcept {
  can_frame raw{};
  raw.can_id = frame.id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.kind == FrameKind::kRemote) raw.can_id |= CAN_RTR_FLAG;
  if (frame.kind == FrameKind::kError) raw.can_id = (frame.id & CAN_ERR_MASK) | CAN_ERR_FLAG;
  raw.len = std::min<std::uint8_t>(frame.size, CAN_MAX_DLEN);
  std::copy_n(frame.data.begin(), raw.len, raw.data);
  return raw;
}

CanFrame fromKernelFd(const canfd_frame& raw) noexcept {
  CanFrame frame;
  frame.is_fd = true;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = std::min<std::uint8_t>(raw.len, CANFD_MAX_DLEN);
  std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

canfd_frame toKernelFd(const CanFrame& frame) noexcept {
  canfd_frame raw{};
  raw.can_id = frame.id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  const int size = std::min<int>(frame.size, CANFD_MAX_DLEN);
  raw.len = static_cast<std::uint8_t>(fdSize(size));
  raw.flags = CANFD_BRS;
  std::copy_n(frame.data.begin(), size, raw.data);
  return raw;
}

std::size_t putKernelFrame(const CanFrame& frame, canfd_frame& room) noexcept {
  if (frame.is_fd) {
    room = toKernelFd(frame);
    return CANFD_MTU;
  }
  const can_frame raw = toKernel(frame);
  std::memcpy(&room, &raw, sizeof(raw));
  return CAN_MTU;
}

CanFrame takeKernelFrame(const canfd_frame& room, std::size_t bytes) noexcept {
  if (bytes == CANFD_MTU) return fromKernelFd(room);
  can_frame raw;
  std::memcpy(&raw, &room, sizeof(raw));
  return fromKernel(raw);
}

void failOnInterface(int error_number, const std::string& interface, const std::string& problem) {
  throw std::system_error(error_number, std::system_category(), interface + ": " + problem);
}

}  // namespace tactus
