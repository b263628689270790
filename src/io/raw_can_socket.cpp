#include "tactus/io/raw_can_socket.h"

#include <errno.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tactus/io/kernel_frame.h"

namespace tactus {

RawCanSocket::RawCanSocket(const std::string& interface) {
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
  if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return;
  const int problem = errno;
  close(descriptor_);
  failOnInterface(problem, interface, "is no CAN interface");
}

RawCanSocket::~RawCanSocket() { close(descriptor_); }

void RawCanSocket::receive(FrameBatch& frames) noexcept {
  frames.clear();
  can_frame raw;
  ssize_t size = 0;
  while (frames.size() < FrameBatch::kCapacity &&
         (size = read(descriptor_, &raw, sizeof(raw))) == CAN_MTU)
    frames.push(fromKernel(raw));
  if (size < 0 && errno == ENODEV) is_gone_ = true;
}

void RawCanSocket::send(std::span<const CanFrame> frames) noexcept {
  for (const CanFrame& frame : frames) {
    const can_frame raw = toKernel(frame);
    if (write(descriptor_, &raw, sizeof(raw)) != CAN_MTU) ++refused_;
  }
}

}  // namespace tactus
