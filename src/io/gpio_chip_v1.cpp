#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>

#include <array>

#include "gpio_chip.h"

namespace tactus {
namespace {

using Levels = std::array<int, kMaxGpioLines>;

int requestType(GpioDirection direction) {
  switch (direction) {
    case GpioDirection::kInput:
      return GPIOD_LINE_REQUEST_DIRECTION_INPUT;
    case GpioDirection::kOutput:
      return GPIOD_LINE_REQUEST_DIRECTION_OUTPUT;
    case GpioDirection::kInputWithEdges:
      break;
  }
  return GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
}

/// The lines are given back when their chip is closed.
class RequestV1 final : public GpioRequest {
 public:
  RequestV1(const gpiod_line_bulk& lines, int events) : lines_(lines), events_(events) {}

  bool read(std::span<bool> levels) noexcept override {
    Levels values{};
    if (gpiod_line_get_value_bulk(&lines_, values.data()) != 0) return false;
    for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = values[i] != 0;
    return true;
  }

  bool write(std::span<const bool> levels) noexcept override {
    Levels values{};
    for (std::size_t i = 0; i < levels.size(); ++i) values[i] = levels[i];
    return gpiod_line_set_value_bulk(&lines_, values.data()) == 0;
  }

  bool readEdges(GpioEdges& edges) noexcept override {
    std::array<gpiod_line_event, kMaxGpioEdges> events;
    const int count = gpiod_line_event_read_fd_multiple(events_, events.data(), kMaxGpioEdges);
    for (int i = 0; i < count; ++i) {
      edges.has_risen |= events[i].event_type == GPIOD_LINE_EVENT_RISING_EDGE;
      edges.has_fallen |= events[i].event_type == GPIOD_LINE_EVENT_FALLING_EDGE;
    }
    return count >= 0 || errno == EAGAIN;
  }

 private:
  gpiod_line_bulk lines_;
  int events_;  ///< descriptor; -1: no edges
};

class ChipV1 final : public GpioChip {
 public:
  explicit ChipV1(gpiod_chip* chip) : chip_(chip) {}
  ~ChipV1() override { gpiod_chip_close(chip_); }
  ChipV1(const ChipV1&) = delete;
  ChipV1& operator=(const ChipV1&) = delete;

  int lineCount() override { return static_cast<int>(gpiod_chip_num_lines(chip_)); }

  std::optional<std::string> user(int line) override {
    gpiod_line* const found = gpiod_chip_get_line(chip_, static_cast<unsigned>(line));
    if (found == nullptr || !gpiod_line_is_used(found)) return std::nullopt;
    const char* const name = gpiod_line_consumer(found);
    return name == nullptr ? "the kernel" : name;
  }

  std::unique_ptr<GpioRequest> request(const std::vector<int>& lines, GpioDirection direction,
                                       std::span<const bool> levels) override {
    gpiod_line_bulk bulk;
    gpiod_line_bulk_init(&bulk);
    Levels values{};
    for (std::size_t i = 0; i < lines.size(); ++i) {
      gpiod_line* const line = gpiod_chip_get_line(chip_, static_cast<unsigned>(lines[i]));
      if (line == nullptr) return nullptr;
      gpiod_line_bulk_add(&bulk, line);
      values[i] = levels[i];
    }
    const int pull =
        levels[0] ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP : GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    gpiod_line_request_config config{kGpioConsumer, requestType(direction),
                                     direction == GpioDirection::kOutput ? 0 : pull};
    bool is_requested = gpiod_line_request_bulk(&bulk, &config, values.data()) == 0;
    if (!is_requested && mayLackPull(direction)) {
      config.flags = 0;
      is_requested = gpiod_line_request_bulk(&bulk, &config, values.data()) == 0;
    }
    if (!is_requested) return nullptr;
    int events = -1;
    if (direction == GpioDirection::kInputWithEdges) {
      events = gpiod_line_event_get_fd(gpiod_line_bulk_get_line(&bulk, 0));
      if (events < 0 || fcntl(events, F_SETFL, O_NONBLOCK) != 0) {
        gpiod_line_release_bulk(&bulk);
        return nullptr;
      }
    }
    return std::make_unique<RequestV1>(bulk, events);
  }

 private:
  gpiod_chip* chip_;
};

}  // namespace

std::unique_ptr<GpioChip> findGpioChip(const std::string& name) {
  gpiod_chip* const chip = gpiod_chip_open_by_name(name.c_str());
  if (chip == nullptr) return nullptr;
  return std::make_unique<ChipV1>(chip);
}

}  // namespace tactus
