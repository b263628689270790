#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>

namespace tactus::test {

/// While it lives standard error is a pipe that nobody has read and that is full.
class UnreadStderr {
 public:
  UnreadStderr() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
    reading_ = ends[0];
    const std::string page(4096, '.');
    while (::write(ends[1], page.data(), page.size()) > 0) {
    }
    // Whoever writes to it now waits.
    ::fcntl(ends[1], F_SETFL, ::fcntl(ends[1], F_GETFL) & ~O_NONBLOCK);
    before_ = ::dup(STDERR_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[1]);
  }
  ~UnreadStderr() {
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    ::close(reading_);
  }
  UnreadStderr(const UnreadStderr&) = delete;
  UnreadStderr& operator=(const UnreadStderr&) = delete;

  /// What is in it, without what it was filled with.
  std::string read() const {
    std::string text;
    std::array<char, 4096> room{};
    for (ssize_t size = 0; (size = ::read(reading_, room.data(), room.size())) > 0;)
      text += std::string_view(room.data(), static_cast<std::size_t>(size));
    std::erase(text, '.');
    return text;
  }

 private:
  int reading_ = -1, before_ = -1;
};

}  // namespace tactus::test
