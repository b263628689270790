#include "tactus/record/message.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <climits>
#include <exception>
#include <iterator>
#include <string_view>

namespace tactus {
namespace {

/// Messages since the last one that found room.
std::atomic<int> lost{0};

constexpr int kPatience_ms = 50;

/// Standard error. A terminal with room for a byte, or a pipe whose last page another thread takes,
/// lets a write wait however poll() answers: those are opened anew without waiting, which leaves
/// them as they are for all others. A socket has room for a line where poll() says so, and a file
/// always.
class StandardError {
 public:
  StandardError() {
    struct stat what {};
    const bool may_wait =
        ::fstat(STDERR_FILENO, &what) == 0 && (S_ISFIFO(what.st_mode) || S_ISCHR(what.st_mode));
    if (may_wait) own_ = ::open("/proc/self/fd/2", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  }
  ~StandardError() {
    if (own_ >= 0) ::close(own_);
  }
  StandardError(const StandardError&) = delete;
  StandardError& operator=(const StandardError&) = delete;

  int descriptor() const noexcept { return own_ >= 0 ? own_ : STDERR_FILENO; }

 private:
  int own_ = -1;
};

/// Where poll() tells of an error nobody is left to wait for.
bool write(std::string_view text) noexcept {
  const StandardError standard_error;
  const int descriptor = standard_error.descriptor();
  while (!text.empty()) {
    pollfd polled{descriptor, POLLOUT, 0};
    if (::poll(&polled, 1, kPatience_ms) != 1 || polled.revents != POLLOUT) return false;
    const ssize_t size =
        ::write(descriptor, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
    if (size <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  return true;
}

}  // namespace

void sayLine(fmt::string_view format, fmt::format_args values) noexcept {
  const int lost_before = lost.exchange(0);
  bool is_said = false;
  try {
    fmt::memory_buffer text;  // up to 500 bytes without asking for memory
    const auto end = std::back_inserter(text);
    if (lost_before > 0)
      fmt::format_to(end, "tactusd: messages that nobody read and that are lost: {}\n",
                     lost_before);
    fmt::format_to(end, "tactusd: ");
    fmt::vformat_to(end, format, values);
    text.push_back('\n');
    is_said = write({text.data(), text.size()});
  } catch (const std::exception&) {  // no memory
  }
  if (!is_said) lost += lost_before + 1;
}

}  // namespace tactus
