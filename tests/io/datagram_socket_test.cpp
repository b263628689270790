#include "tactus/io/datagram_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace tactus {
namespace {

/// As of PlotJuggler, which listens at addresses of IPv4 alone.
class DatagramReceiver {
 public:
  DatagramReceiver() : fd_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(fd_, generic, size), 0);
    EXPECT_EQ(::getsockname(fd_, generic, &size), 0);
    port_ = std::to_string(ntohs(address.sin_port));
  }
  ~DatagramReceiver() { ::close(fd_); }
  DatagramReceiver(const DatagramReceiver&) = delete;
  DatagramReceiver& operator=(const DatagramReceiver&) = delete;

  const std::string& port() const { return port_; }
  /// Empty: nothing has come.
  std::string received() const {
    std::array<char, 16> room{};
    const ssize_t size = ::recv(fd_, room.data(), room.size(), MSG_DONTWAIT);
    return {room.data(), static_cast<std::size_t>(std::max(size, ssize_t{0}))};
  }

 private:
  int fd_;
  std::string port_;
};

TEST(DatagramSocket, ReachesThisComputerByAnyOfItsNames) {
  const DatagramReceiver receiver;
  for (const char* host : {"", "127.0.0.1:", "localhost:", "[127.0.0.1]:"}) {
    DatagramSocket(host + receiver.port()).send("hello");
    EXPECT_EQ(receiver.received(), "hello") << host;
  }
}

TEST(DatagramSocket, RefusesWhatIsNoPort) {
  for (const char* to : {"", "0", "65536", "-1", "12x", "localhost:", "127.0.0.1"})
    EXPECT_THROW(DatagramSocket{to}, std::invalid_argument) << to;
}

}  // namespace
}  // namespace tactus
