#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tactus {

/// A local socket of packets (AF_UNIX, SOCK_SEQPACKET), closed at the end. Errors are
/// std::system_error with the path.
class PacketSocket {
 public:
  PacketSocket() = default;
  /// Takes an open one.
  explicit PacketSocket(int fd) noexcept : fd_(fd) {}
  PacketSocket(PacketSocket&& other) noexcept;
  PacketSocket& operator=(PacketSocket&& other) noexcept;
  ~PacketSocket();

  /// Waits up to patience_s for each packet.
  static PacketSocket connectTo(const std::string& path, double patience_s);
  /// A new one in place of any file there, for its owner and group, that never waits.
  static PacketSocket listenAt(const std::string& path, int backlog);
  /// The one that the service manager has opened; empty: there is none. Throws if it is of another
  /// kind.
  static PacketSocket ofManager();

  bool isOpen() const noexcept { return fd_ >= 0; }
  int fd() const noexcept { return fd_; }

  /// Of one that listens: the next that wants to talk, which never waits; empty: nobody.
  PacketSocket accept() const noexcept;
  /// Bytes of the packet, of which only those that find room are there; 0: the other side has left;
  /// -1: nothing came.
  long receive(std::span<char> room) const noexcept;
  /// The same, but the packet stays there, and nothing is waited for.
  long peek(std::span<char> room) const noexcept;
  /// Bytes of all packets that have come, and were not received yet.
  long waiting() const noexcept;
  /// False: it was not taken.
  bool send(std::string_view packet) const noexcept;

 private:
  int fd_ = -1;
};

}  // namespace tactus
