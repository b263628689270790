#include "tactus/io/can_socket.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tactus/io/kernel_frame.h"

namespace tactus {
namespace {

// Bytes of kernel memory, which the kernel doubles; a frame takes 768.
constexpr int kSendBuffer = 8192;  ///< about twenty frames: a cycle has fewer
/// Two batches: what came before the first cycle or in a late one is read within two cycles, and is
/// no flood.
constexpr int kReceiveBuffer = 2 * static_cast<int>(FrameBatch::kCapacity) * 768 / 2;

/// Closes what a failing constructor has opened.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }
  int release() { return std::exchange(value_, -1); }

 private:
  int value_;
};

ifreq requestFor(const std::string& interface) {
  ifreq request{};
  if (interface.empty() || interface.size() >= sizeof(request.ifr_name))
    failOnInterface(EINVAL, interface, "is no name of a network interface, expected one as can0");
  std::memcpy(request.ifr_name, interface.data(), interface.size());
  return request;
}

/// Asks the kernel for one property of an interface, by a SIOCGIF... request.
ifreq ask(const std::string& interface, unsigned long what) {
  ifreq request = requestFor(interface);
  const Descriptor any(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (any.get() < 0) failOnInterface(errno, interface, "cannot open a socket to ask for it");
  if (ioctl(any.get(), what, &request) != 0)
    failOnInterface(errno, interface,
                    "no such network interface; `ip link` lists them, and `ip link set " +
                        interface + " up type can bitrate 1000000` brings one up");
  return request;
}

template <typename Value>
void setOption(int descriptor, const std::string& interface, int option, const Value* value,
               std::size_t count, const char* name) {
  if (setsockopt(descriptor, SOL_CAN_RAW, option, value,
                 static_cast<socklen_t>(count * sizeof(Value))) != 0)
    failOnInterface(errno, interface, std::string("the kernel refuses the socket option ") + name);
}

/// Mask bits beside the id's keep ids of the other length and remote frames out of the kernel's
/// match.
void setFilters(int descriptor, const std::string& interface, std::span<const IdFilter> received,
                std::span<const IdFilter> sent) {
  std::vector<can_filter> filters;
  for (const auto& ids : {received, sent}) {
    for (const IdFilter& ours : ids) {
      const canid_t bits = ours.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK;
      const canid_t kind = ours.is_extended ? CAN_EFF_FLAG : 0;
      filters.push_back(
          {(ours.id & bits) | kind, (ours.mask & bits) | CAN_EFF_FLAG | CAN_RTR_FLAG});
    }
  }
  setOption(descriptor, interface, CAN_RAW_FILTER, filters.data(), filters.size(),
            "CAN_RAW_FILTER");
}

void setOptions(int descriptor, const std::string& interface) {
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  setOption(descriptor, interface, CAN_RAW_ERR_FILTER, &all_errors, 1, "CAN_RAW_ERR_FILTER");
  const int on = 1;
  setOption(descriptor, interface, CAN_RAW_RECV_OWN_MSGS, &on, 1, "CAN_RAW_RECV_OWN_MSGS");
  if (setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof(kSendBuffer)) != 0 ||
      setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof(kReceiveBuffer)) != 0)
    failOnInterface(errno, interface, "the kernel refuses short buffers (SO_SNDBUF, SO_RCVBUF)");
}

void bindTo(int descriptor, const std::string& interface) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = ask(interface, SIOCGIFINDEX).ifr_ifindex;
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
    failOnInterface(errno, interface, "is no CAN interface");
  requireUp(interface);
}

}  // namespace

struct CanSocket::Messages {
  static constexpr std::size_t kCount = FrameBatch::kCapacity;

  Messages(std::span<const IdFilter> filters, bool carries_fd)
      : is_fd(carries_fd), received(filters.begin(), filters.end()) {
    for (std::size_t i = 0; i < kCount; ++i) {
      parts[i] = {&frames[i], carries_fd ? CANFD_MTU : CAN_MTU};
      headers[i].msg_hdr.msg_iov = &parts[i];
      headers[i].msg_hdr.msg_iovlen = 1;
    }
  }

  const bool is_fd;
  std::array<canfd_frame, kCount> frames{};
  std::array<iovec, kCount> parts{};
  std::array<mmsghdr, kCount> headers{};
  std::vector<IdFilter> received;
};

CanSocket::CanSocket(const std::string& interface, std::span<const IdFilter> received,
                     std::span<const IdFilter> sent, bool is_fd)
    : messages_(std::make_unique<Messages>(received, is_fd)) {
  ask(interface, SIOCGIFINDEX);  // the plainer message, if there is neither interface nor CAN
  Descriptor opened(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (opened.get() < 0)
    failOnInterface(errno, interface,
                    "this kernel opens no CAN sockets; `modprobe can_raw` may help");
  setFilters(opened.get(), interface, received, sent);
  setOptions(opened.get(), interface);
  if (is_fd) {
    const int on = 1;
    setOption(opened.get(), interface, CAN_RAW_FD_FRAMES, &on, 1, "CAN_RAW_FD_FRAMES");
  }
  bindTo(opened.get(), interface);
  if (is_fd) requireFd(interface);
  descriptor_ = opened.release();
}

CanSocket::~CanSocket() { close(descriptor_); }

void CanSocket::receive(FrameBatch& frames) noexcept {
  frames.clear();
  const int count =
      recvmmsg(descriptor_, messages_->headers.data(), Messages::kCount, MSG_DONTWAIT, nullptr);
  if (count < 0) {
    monitor_.onReceiveError(errno);
    monitor_.onReceived(0, false);
    return;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    CanFrame frame;
    if (take(i, frame)) frames.push(frame);
  }
  monitor_.onReceived(static_cast<int>(frames.size()), count == Messages::kCount);
}

bool CanSocket::take(std::size_t message, CanFrame& frame) noexcept {
  const mmsghdr& header = messages_->headers[message];
  const bool is_frame =
      header.msg_len == CAN_MTU || (messages_->is_fd && header.msg_len == CANFD_MTU);
  const bool is_whole = is_frame && (header.msg_hdr.msg_flags & MSG_TRUNC) == 0;
  frame = takeKernelFrame(messages_->frames[message], header.msg_len);
  if (is_whole && (header.msg_hdr.msg_flags & MSG_CONFIRM) != 0) {
    monitor_.onConfirmed(1);
  } else if (is_whole && frame.kind == FrameKind::kError) {
    monitor_.onErrorFrame(frame);
  } else if (is_whole && isExpected(frame)) {
    return true;
  } else {
    monitor_.onForeignFrame();
  }
  return false;
}

/// What others send by the ids of our own frames passes the kernel's filters, but not this.
bool CanSocket::isExpected(const CanFrame& frame) const noexcept {
  if (frame.kind != FrameKind::kData) return false;
  return std::any_of(messages_->received.begin(), messages_->received.end(),
                     [&frame](const IdFilter& filter) {
                       return frame.extended == filter.is_extended && frame.is_fd == filter.is_fd &&
                              ((frame.id ^ filter.id) & filter.mask) == 0;
                     });
}

bool CanSocket::send(std::span<const CanFrame> frames) noexcept {
  return monitor_.maySend() && !frames.empty() && handOver(frames) > 0;
}

void CanSocket::probe(const CanFrame& harmless) noexcept {
  if (monitor_.mayProbe()) handOver({&harmless, 1});
}

int CanSocket::handOver(std::span<const CanFrame> frames) noexcept {
  const std::size_t count = std::min(frames.size(), Messages::kCount);
  for (std::size_t i = 0; i < count; ++i) {
    messages_->parts[i].iov_len = putKernelFrame(frames[i], messages_->frames[i]);
    messages_->headers[i].msg_hdr.msg_flags = 0;
  }
  const int accepted =
      sendmmsg(descriptor_, messages_->headers.data(), static_cast<unsigned>(count), MSG_DONTWAIT);
  if (messages_->is_fd)  // what comes may be longer than what went
    for (std::size_t i = 0; i < count; ++i) messages_->parts[i].iov_len = CANFD_MTU;
  if (accepted < 0) monitor_.onSendError(errno);
  monitor_.onSent(std::max(0, accepted), static_cast<int>(frames.size()));
  return accepted;
}

int transmitQueueLength(const std::string& interface) {
  return ask(interface, SIOCGIFTXQLEN).ifr_qlen;
}

void requireUp(const std::string& interface) {
  if ((ask(interface, SIOCGIFFLAGS).ifr_flags & IFF_UP) == 0)
    failOnInterface(ENETDOWN, interface,
                    "the interface is down; `ip link set " + interface + " up`");
}

void requireFd(const std::string& interface) {
  if (ask(interface, SIOCGIFMTU).ifr_mtu < static_cast<int>(CANFD_MTU))
    failOnInterface(EMSGSIZE, interface,
                    "is not set up for CAN FD; `ip link set " + interface +
                        " up type can bitrate 1000000 dbitrate 5000000 fd on`, or of a vcan `ip "
                        "link set " +
                        interface + " mtu 72`");
}

/// A name in the abstract name space of unix sockets, which the kernel gives to one socket at a
/// time: no file to be left behind, no permission to be asked.
InterfaceLock::InterfaceLock(const std::string& interface, const std::string& program) {
  requestFor(interface);
  Descriptor opened(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (opened.get() < 0) failOnInterface(errno, interface, "cannot open a unix socket to lock it");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = program + "-" + interface;
  std::memcpy(address.sun_path + 1, name.data(), name.size());
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(opened.get(), reinterpret_cast<const sockaddr*>(&address), length) != 0) {
    if (errno != EADDRINUSE) failOnInterface(errno, interface, "cannot be locked");
    throw std::runtime_error(interface + ": another " + program +
                             " already runs on this interface; stop it first");
  }
  descriptor_ = opened.release();
}

InterfaceLock::~InterfaceLock() { close(descriptor_); }

}  // namespace tactus
