#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace tactus::test {

/// A service manager's end of sd_notify(3), named in the environment for as long as it lives.
class NotifySocket {
 public:
  NotifySocket() : descriptor_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;  // and no name: the kernel chooses an abstract one
    EXPECT_EQ(bind(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(sa_family_t)), 0);
    socklen_t size = sizeof(address);
    EXPECT_EQ(getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    const std::size_t length = size - offsetof(sockaddr_un, sun_path) - 1;
    setenv("NOTIFY_SOCKET", ("@" + std::string(address.sun_path + 1, length)).c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(descriptor_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  void askForWatchdog(int timeout_us) {
    setenv("WATCHDOG_USEC", std::to_string(timeout_us).c_str(), 1);
  }

  /// The next message; empty if none comes within the time.
  std::string receive(int timeout_ms) {
    pollfd polled{descriptor_, POLLIN, 0};
    if (poll(&polled, 1, timeout_ms) <= 0) return "";
    char text[4096];
    const ssize_t size = recv(descriptor_, text, sizeof(text), 0);
    return {text, size > 0 ? static_cast<std::size_t>(size) : 0};
  }
  std::string receive() { return receive(0); }

  /// Up to where a sender would wait.
  void fill() {
    sockaddr_un address{};
    socklen_t size = sizeof(address);
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
    const int sender = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    while (sendto(sender, ".", 1, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&address), size) == 1) {
    }
    close(sender);
  }
  void readAll() {
    while (!receive().empty()) {
    }
  }

 private:
  int descriptor_;
};

}  // namespace tactus::test
