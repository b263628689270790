#include <gpiod.h>

#include <cerrno>

#include "io/fake_gpiod.h"

using tactus::test::answers;
using tactus::test::fake_chip;
using tactus::test::FakeLine;
using tactus::test::Requested;

// The library shows neither of them.
struct gpiod_chip {};
struct gpiod_line {
  FakeLine* line;
};

namespace {

gpiod_chip chip;
std::array<gpiod_line, tactus::test::FakeChip::kLines> lines;

Requested requestedAs(int type) {
  if (type == GPIOD_LINE_REQUEST_DIRECTION_OUTPUT) return Requested::kOutput;
  return type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES ? Requested::kEdges : Requested::kInput;
}

}  // namespace

gpiod_chip* gpiod_chip_open_by_name(const char* name) {
  return tactus::test::openFakeChip(name) ? &chip : nullptr;
}

void gpiod_chip_close(gpiod_chip*) {
  fake_chip.is_open = false;
  for (FakeLine& line : fake_chip.lines) line.requested = Requested::kNo;
}

unsigned gpiod_chip_num_lines(gpiod_chip*) { return fake_chip.kLines; }

gpiod_line* gpiod_chip_get_line(gpiod_chip*, unsigned offset) {
  if (offset >= fake_chip.kLines) return nullptr;
  lines[offset].line = &fake_chip.lines[offset];
  return &lines[offset];
}

bool gpiod_line_is_used(gpiod_line* line) {
  return line->line->is_taken || line->line->requested != Requested::kNo;
}

const char* gpiod_line_consumer(gpiod_line* line) {
  return line->line->is_taken ? nullptr : "tactusd";
}

int gpiod_line_request_bulk(gpiod_line_bulk* bulk, const gpiod_line_request_config* config,
                            const int* values) {
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    const int pull = (config->flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP) != 0     ? 1
                     : (config->flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN) != 0 ? -1
                                                                                     : 0;
    if (!requestLine(*bulk->lines[i]->line, requestedAs(config->request_type), values[i], pull))
      return -1;
  }
  return 0;
}

void gpiod_line_release_bulk(gpiod_line_bulk* bulk) {
  for (unsigned i = 0; i < bulk->num_lines; ++i) bulk->lines[i]->line->requested = Requested::kNo;
}

int gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values) {
  if (!answers()) return -1;
  for (unsigned i = 0; i < bulk->num_lines; ++i) values[i] = bulk->lines[i]->line->level;
  return 0;
}

int gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (!answers()) return -1;
  for (unsigned i = 0; i < bulk->num_lines; ++i) {
    if (bulk->lines[i]->line->requested != Requested::kOutput) return -1;
    bulk->lines[i]->line->level = values[i];
  }
  return 0;
}

int gpiod_line_event_get_fd(gpiod_line*) { return tactus::test::edgeDescriptor(); }

int gpiod_line_event_read_fd_multiple(int descriptor, gpiod_line_event* events, unsigned count) {
  const std::vector<int> levels = tactus::test::readEdges(descriptor, count);
  for (std::size_t i = 0; i < levels.size(); ++i)
    events[i].event_type =
        levels[i] != 0 ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE;
  return levels.empty() ? -1 : static_cast<int>(levels.size());
}
