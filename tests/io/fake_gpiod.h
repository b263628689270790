#pragma once

#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

/// A GPIO chip in memory behind the functions of libgpiod that the daemon calls. Included by one
/// source only: its definitions take the place of the library's in the whole program.
struct gpiod_line {
  unsigned number = 0;
  int level = 0;
  int requested = 0;  ///< type of the request; 0: free
  bool is_taken = false;
};

struct gpiod_chip {
  static constexpr unsigned kLines = 8;

  bool is_present = true;
  bool is_open = false;
  bool has_events = true;
  bool is_gone = false;  ///< in mid run: all calls fail
  int calls = 0;         ///< that are system calls in a cycle
  std::array<gpiod_line, kLines> lines{};
  std::vector<int> events;  ///< of the line that was requested with events
  int descriptor = -1;
};

namespace tactus::test {
inline gpiod_chip fake_chip;

/// A new chip with all lines low.
inline gpiod_chip& resetFakeChip() {
  if (fake_chip.descriptor >= 0) close(fake_chip.descriptor);
  fake_chip = gpiod_chip{};
  for (unsigned i = 0; i < gpiod_chip::kLines; ++i) fake_chip.lines[i].number = i;
  return fake_chip;
}

/// Drives an input from outside, with the edge that it makes.
inline void drive(unsigned line, int level) {
  if (fake_chip.lines[line].level == level) return;
  fake_chip.lines[line].level = level;
  if (fake_chip.lines[line].requested == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES)
    fake_chip.events.push_back(level != 0 ? GPIOD_LINE_EVENT_RISING_EDGE
                                          : GPIOD_LINE_EVENT_FALLING_EDGE);
}

/// A chip that has gone refuses every call.
inline bool answers() {
  ++fake_chip.calls;
  errno = EIO;
  return !fake_chip.is_gone;
}
}  // namespace tactus::test

gpiod_chip* gpiod_chip_open_by_name(const char* name) {
  errno = ENOENT;
  if (!tactus::test::fake_chip.is_present || std::strcmp(name, "gpiochip0") != 0) return nullptr;
  tactus::test::fake_chip.is_open = true;
  return &tactus::test::fake_chip;
}

void gpiod_chip_close(gpiod_chip* chip) {
  chip->is_open = false;
  for (gpiod_line& line : chip->lines) line.requested = 0;
}

unsigned gpiod_chip_num_lines(gpiod_chip*) { return gpiod_chip::kLines; }

gpiod_line* gpiod_chip_get_line(gpiod_chip* chip, unsigned offset) {
  return offset < gpiod_chip::kLines ? &chip->lines[offset] : nullptr;
}

unsigned gpiod_line_offset(gpiod_line* line) { return line->number; }

int gpiod_line_request_bulk(gpiod_line_bulk* bulk, const gpiod_line_request_config* config,
                            const int* values) {
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    gpiod_line& line = *bulk->lines[i];
    errno = EBUSY;
    if (line.is_taken || line.requested != 0) return -1;
    errno = EINVAL;
    if (config->request_type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES &&
        !tactus::test::fake_chip.has_events)
      return -1;
    line.requested = config->request_type;
    if (config->request_type == GPIOD_LINE_REQUEST_DIRECTION_OUTPUT) line.level = values[i];
  }
  return 0;
}

int gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values) {
  if (!tactus::test::answers()) return -1;
  for (unsigned i = 0; i < bulk->num_lines; ++i) values[i] = bulk->lines[i]->level;
  return 0;
}

int gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (!tactus::test::answers()) return -1;
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    if (bulk->lines[i]->requested != GPIOD_LINE_REQUEST_DIRECTION_OUTPUT) return -1;
    bulk->lines[i]->level = values[i];
  }
  return 0;
}

int gpiod_line_event_get_fd(gpiod_line*) {
  return tactus::test::fake_chip.descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
}

/// Would block for ever on a descriptor that waits: fails in a way that shows.
int gpiod_line_event_read_fd_multiple(int descriptor, gpiod_line_event* events, unsigned count) {
  if (!tactus::test::answers()) return -1;
  errno = EDEADLK;
  if ((fcntl(descriptor, F_GETFL) & O_NONBLOCK) == 0) return -1;
  errno = EAGAIN;
  std::vector<int>& waiting = tactus::test::fake_chip.events;
  const std::size_t read = std::min<std::size_t>(count, waiting.size());
  for (std::size_t i = 0; i < read; ++i) events[i].event_type = waiting[i];
  waiting.erase(waiting.begin(), waiting.begin() + static_cast<long>(read));
  return read == 0 ? -1 : static_cast<int>(read);
}
