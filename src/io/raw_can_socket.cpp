#include "tactus/io/raw_can_socket.h"

#include <errno.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tactus/io/kernel_frame.h"

namespace tactus {

RawCanSocket::RawCanSocket(const std::string& interface, bool is_fd) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0)
    failOnInterface(
        errno, interface,
        "no such network interface; `ip link add " + interface + " type vcan` makes a virtual one");
  descriptor_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor_ < 0)
    failOnInterface(errno, interface,
                    "this kernel opens no CAN sockets; `modprobe can_raw` may help");
  const int fd_frames = is_fd ? 1 : 0;
  const bool is_set = !is_fd || setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &fd_frames,
                                           sizeof(fd_frames)) == 0;
  if (is_set &&
      bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0)
    return;
  const int problem = errno;
  close(descriptor_);
  failOnInterface(problem, interface, is_set ? "is no CAN interface" : "carries no CAN FD");
}

RawCanSocket::~RawCanSocket() { close(descriptor_); }

void RawCanSocket::receive(FrameBatch& frames) noexcept {
  frames.clear();
  canfd_frame raw;
  ssize_t size = 0;
  const auto isFrame = [&size] { return size == CAN_MTU || size == CANFD_MTU; };
  while (frames.size() < FrameBatch::kCapacity &&
         (size = read(descriptor_, &raw, sizeof(raw)), isFrame()))
    frames.push(takeKernelFrame(raw, static_cast<std::size_t>(size)));
  if (size < 0 && errno == ENODEV) is_gone_ = true;
}

void RawCanSocket::send(std::span<const CanFrame> frames) noexcept {
  for (const CanFrame& frame : frames) {
    canfd_frame raw;
    const std::size_t size = putKernelFrame(frame, raw);
    if (write(descriptor_, &raw, size) != static_cast<ssize_t>(size)) ++refused_;
  }
}

}  // namespace tactus
