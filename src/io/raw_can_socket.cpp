#include "tactus/io/raw_can_socket.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>

namespace tactus {
namespace {

[[noreturn]] void fail(int error_number, const std::string& interface, const std::string& problem) {
  throw std::system_error(error_number, std::system_category(), interface + ": " + problem);
}

CanFrame fromKernel(const can_frame& raw) noexcept {
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  if ((raw.can_id & CAN_RTR_FLAG) != 0) frame.kind = FrameKind::kRemote;
  frame.size = std::min<std::uint8_t>(raw.len, CAN_MAX_DLEN);
  std::copy_n(raw.data, CAN_MAX_DLEN, frame.data.begin());
  return frame;
}

can_frame toKernel(const CanFrame& frame) noexcept {
  can_frame raw{};
  raw.can_id = frame.id;
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.kind == FrameKind::kRemote) raw.can_id |= CAN_RTR_FLAG;
  if (frame.kind == FrameKind::kError) raw.can_id |= CAN_ERR_FLAG;
  raw.len = frame.size;
  std::copy_n(frame.data.begin(), CAN_MAX_DLEN, raw.data);
  return raw;
}

}  // namespace

RawCanSocket::RawCanSocket(const std::string& interface) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0)
    fail(
        errno, interface,
        "no such network interface; `ip link add " + interface + " type vcan` makes a virtual one");
  descriptor_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor_ < 0)
    fail(errno, interface, "this kernel opens no CAN sockets; `modprobe can_raw` may help");
  if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return;
  const int problem = errno;
  close(descriptor_);
  fail(problem, interface, "is no CAN interface");
}

RawCanSocket::~RawCanSocket() { close(descriptor_); }

void RawCanSocket::receive(FrameBatch& frames) noexcept {
  frames.clear();
  can_frame raw;
  while (frames.size() < FrameBatch::kCapacity && read(descriptor_, &raw, sizeof(raw)) == CAN_MTU)
    frames.push(fromKernel(raw));
}

void RawCanSocket::send(std::span<const CanFrame> frames) noexcept {
  for (const CanFrame& frame : frames) {
    const can_frame raw = toKernel(frame);
    if (write(descriptor_, &raw, sizeof(raw)) != CAN_MTU) ++refused_;
  }
}

}  // namespace tactus
