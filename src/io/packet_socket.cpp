#include "tactus/io/packet_socket.h"

#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

namespace tactus {
namespace {

constexpr mode_t kOwnerAndGroup = 0660;

[[noreturn]] void fail(const std::string& path, int reason) {
  throw std::system_error(reason, std::generic_category(), path);
}

sockaddr_un addressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) fail(path, ENAMETOOLONG);
  path.copy(address.sun_path, path.size());
  return address;
}

const sockaddr* generic(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

PacketSocket open(const std::string& path, int flags) {
  PacketSocket socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | flags, 0));
  if (!socket.isOpen()) fail(path, errno);
  return socket;
}

/// Whole size of a packet, though the room may be less.
long receivePacket(int fd, std::span<char> room, int flags) noexcept {
  long size;
  do {
    size = ::recv(fd, room.data(), room.size(), MSG_TRUNC | flags);
  } while (size < 0 && errno == EINTR);  // that a signal came says nothing of the other side
  return size;
}

/// Not of a socket whose process is gone. One whose backlog is full is not.
bool isListenedAt(const std::string& path, const sockaddr_un& address) {
  const PacketSocket probe = open(path, SOCK_NONBLOCK);
  return ::connect(probe.fd(), generic(address), sizeof(address)) == 0 || errno == EAGAIN;
}

}  // namespace

PacketSocket::PacketSocket(PacketSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

PacketSocket& PacketSocket::operator=(PacketSocket&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

PacketSocket::~PacketSocket() {
  if (isOpen()) ::close(fd_);
}

PacketSocket PacketSocket::connectTo(const std::string& path, double patience_s) {
  const sockaddr_un address = addressOf(path);
  PacketSocket socket = open(path, 0);
  const timeval patience{.tv_sec = std::lround(patience_s), .tv_usec = 0};
  ::setsockopt(socket.fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  ::setsockopt(socket.fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  if (::connect(socket.fd_, generic(address), sizeof(address)) != 0) fail(path, errno);
  return socket;
}

PacketSocket PacketSocket::listenAt(const std::string& path, int backlog) {
  const sockaddr_un address = addressOf(path);
  if (isListenedAt(path, address)) fail(path, EADDRINUSE);
  PacketSocket socket = open(path, SOCK_NONBLOCK);
  ::unlink(path.c_str());
  if (::bind(socket.fd_, generic(address), sizeof(address)) != 0 ||
      ::chmod(path.c_str(), kOwnerAndGroup) != 0 || ::listen(socket.fd_, backlog) != 0)
    fail(path, errno);
  return socket;
}

PacketSocket PacketSocket::ofManager() {
  if (sd_listen_fds(1) < 1) return {};
  PacketSocket socket(SD_LISTEN_FDS_START);
  if (sd_is_socket(socket.fd_, AF_UNIX, SOCK_SEQPACKET, 1) <= 0)
    fail("the socket of the service manager", EPROTOTYPE);
  return socket;
}

PacketSocket PacketSocket::accept() const noexcept {
  return PacketSocket(::accept4(fd_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
}

long PacketSocket::receive(std::span<char> room) const noexcept {
  return receivePacket(fd_, room, 0);
}

long PacketSocket::peek(std::span<char> room) const noexcept {
  return receivePacket(fd_, room, MSG_PEEK | MSG_DONTWAIT);
}

long PacketSocket::waiting() const noexcept {
  int bytes = 0;
  return ::ioctl(fd_, FIONREAD, &bytes) == 0 ? bytes : 0;
}

bool PacketSocket::send(std::string_view packet) const noexcept {
  ssize_t size;
  do {
    size = ::send(fd_, packet.data(), packet.size(), MSG_NOSIGNAL);
  } while (size < 0 && errno == EINTR);
  return size == static_cast<ssize_t>(packet.size());
}

}  // namespace tactus
