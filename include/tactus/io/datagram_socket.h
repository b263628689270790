#pragma once

#include <string>
#include <string_view>

namespace tactus {

/// Sends datagrams (UDP) to one place, and never waits: what finds no room, or nobody who listens,
/// is lost.
class DatagramSocket {
 public:
  /// "host:port", "[::1]:port" or "port" of this machine. Throws std::system_error or
  /// std::invalid_argument with what is wrong.
  explicit DatagramSocket(const std::string& to);
  ~DatagramSocket();
  DatagramSocket(const DatagramSocket&) = delete;
  DatagramSocket& operator=(const DatagramSocket&) = delete;

  void send(std::string_view datagram) const noexcept;

 private:
  int fd_ = -1;
};

}  // namespace tactus
