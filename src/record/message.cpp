#include "tactus/record/message.h"

#include <poll.h>
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

/// Where poll() tells of room, a pipe, a terminal and the journal's socket take PIPE_BUF at once.
/// Where it tells of an error nobody is left to wait for.
bool write(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::string_view part = text.substr(0, PIPE_BUF);
    pollfd polled{STDERR_FILENO, POLLOUT, 0};
    if (::poll(&polled, 1, kMessagePatience_ms) != 1 || polled.revents != POLLOUT) return false;
    if (::write(STDERR_FILENO, part.data(), part.size()) != std::ssize(part)) return false;
    text.remove_prefix(part.size());
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
