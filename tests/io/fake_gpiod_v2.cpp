#include <gpiod.h>

#include <cerrno>
#include <map>
#include <string>

#include "io/fake_gpiod.h"

using tactus::test::answers;
using tactus::test::fake_chip;
using tactus::test::FakeLine;
using tactus::test::Requested;

// The library shows none of these.
struct gpiod_chip {};
struct gpiod_chip_info {};
struct gpiod_line_info {
  FakeLine line;
};
struct gpiod_line_settings {
  Requested as = Requested::kInput;
  int level = 0;
  int pull = 0;
};
struct gpiod_line_config {
  std::vector<std::pair<unsigned, gpiod_line_settings>> lines;
};
struct gpiod_request_config {
  std::string consumer;
};
struct gpiod_line_request {
  std::vector<unsigned> lines;
};
struct gpiod_edge_event {
  int level = 0;
};
struct gpiod_edge_event_buffer {
  std::vector<gpiod_edge_event> events;
};

namespace {
gpiod_chip chip;
}

gpiod_chip* gpiod_chip_open(const char* path) {
  const std::string text = path, devices = "/dev/";
  const bool is_device = text.starts_with(devices);
  return tactus::test::openFakeChip(is_device ? path + devices.size() : "") ? &chip : nullptr;
}

void gpiod_chip_close(gpiod_chip*) { fake_chip.is_open = false; }

gpiod_chip_info* gpiod_chip_get_info(gpiod_chip*) { return new gpiod_chip_info; }
void gpiod_chip_info_free(gpiod_chip_info* info) { delete info; }
size_t gpiod_chip_info_get_num_lines(gpiod_chip_info*) { return fake_chip.kLines; }

gpiod_line_info* gpiod_chip_get_line_info(gpiod_chip*, unsigned offset) {
  return offset < fake_chip.kLines ? new gpiod_line_info{fake_chip.lines[offset]} : nullptr;
}
void gpiod_line_info_free(gpiod_line_info* info) { delete info; }
bool gpiod_line_info_is_used(gpiod_line_info* info) {
  return info->line.is_taken || info->line.requested != Requested::kNo;
}
const char* gpiod_line_info_get_consumer(gpiod_line_info* info) {
  return info->line.is_taken ? nullptr : "tactusd";
}

gpiod_line_settings* gpiod_line_settings_new() { return new gpiod_line_settings; }
void gpiod_line_settings_free(gpiod_line_settings* settings) { delete settings; }
int gpiod_line_settings_set_direction(gpiod_line_settings* settings,
                                      gpiod_line_direction direction) {
  settings->as = direction == GPIOD_LINE_DIRECTION_OUTPUT ? Requested::kOutput : Requested::kInput;
  return 0;
}
int gpiod_line_settings_set_bias(gpiod_line_settings* settings, gpiod_line_bias bias) {
  settings->pull = bias == GPIOD_LINE_BIAS_PULL_UP ? 1 : bias == GPIOD_LINE_BIAS_PULL_DOWN ? -1 : 0;
  return 0;
}
int gpiod_line_settings_set_edge_detection(gpiod_line_settings* settings, gpiod_line_edge edge) {
  if (edge == GPIOD_LINE_EDGE_BOTH) settings->as = Requested::kEdges;
  return 0;
}
int gpiod_line_settings_set_output_value(gpiod_line_settings* settings, gpiod_line_value value) {
  settings->level = value == GPIOD_LINE_VALUE_ACTIVE;
  return 0;
}

gpiod_line_config* gpiod_line_config_new() { return new gpiod_line_config; }
void gpiod_line_config_free(gpiod_line_config* config) { delete config; }
int gpiod_line_config_add_line_settings(gpiod_line_config* config, const unsigned* offsets,
                                        size_t count, gpiod_line_settings* settings) {
  for (size_t i = 0; i < count; ++i) config->lines.emplace_back(offsets[i], *settings);
  return 0;
}

gpiod_request_config* gpiod_request_config_new() { return new gpiod_request_config; }
void gpiod_request_config_free(gpiod_request_config* config) { delete config; }
void gpiod_request_config_set_consumer(gpiod_request_config* config, const char* consumer) {
  config->consumer = consumer;
}

gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config*,
                                             gpiod_line_config* config) {
  auto* const request = new gpiod_line_request;
  for (const auto& [offset, settings] : config->lines) {
    if (!requestLine(fake_chip.lines[offset], settings.as, settings.level, settings.pull)) {
      const int problem = errno;
      gpiod_line_request_release(request);
      errno = problem;
      return nullptr;
    }
    request->lines.push_back(offset);
  }
  return request;
}

void gpiod_line_request_release(gpiod_line_request* request) {
  for (const unsigned line : request->lines) fake_chip.lines[line].requested = Requested::kNo;
  delete request;
}

int gpiod_line_request_get_values(gpiod_line_request* request, gpiod_line_value* values) {
  if (!answers()) return -1;
  for (size_t i = 0; i < request->lines.size(); ++i)
    values[i] = fake_chip.lines[request->lines[i]].level != 0 ? GPIOD_LINE_VALUE_ACTIVE
                                                              : GPIOD_LINE_VALUE_INACTIVE;
  return 0;
}

int gpiod_line_request_set_values(gpiod_line_request* request, const gpiod_line_value* values) {
  if (!answers()) return -1;
  for (size_t i = 0; i < request->lines.size(); ++i) {
    FakeLine& line = fake_chip.lines[request->lines[i]];
    if (line.requested != Requested::kOutput) return -1;
    line.level = values[i] == GPIOD_LINE_VALUE_ACTIVE;
  }
  return 0;
}

int gpiod_line_request_get_fd(gpiod_line_request*) { return tactus::test::edgeDescriptor(); }

gpiod_edge_event_buffer* gpiod_edge_event_buffer_new(size_t capacity) {
  return new gpiod_edge_event_buffer{std::vector<gpiod_edge_event>(capacity)};
}
void gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* buffer) { delete buffer; }
gpiod_edge_event* gpiod_edge_event_buffer_get_event(gpiod_edge_event_buffer* buffer,
                                                    unsigned long index) {
  return &buffer->events[index];
}
gpiod_edge_event_type gpiod_edge_event_get_event_type(gpiod_edge_event* event) {
  return event->level != 0 ? GPIOD_EDGE_EVENT_RISING_EDGE : GPIOD_EDGE_EVENT_FALLING_EDGE;
}

int gpiod_line_request_read_edge_events(gpiod_line_request*, gpiod_edge_event_buffer* buffer,
                                        size_t max_events) {
  const std::vector<int> levels =
      tactus::test::readEdges(tactus::test::edgeDescriptor(), max_events);
  for (size_t i = 0; i < levels.size(); ++i) buffer->events[i].level = levels[i];
  return levels.empty() ? -1 : static_cast<int>(levels.size());
}
