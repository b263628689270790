#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>

#include <array>

#include "gpio_chip.h"

namespace tactus {
namespace {

template <typename Type, void (*free_it)(Type*)>
struct Freed {
  void operator()(Type* object) const noexcept { free_it(object); }
};
template <typename Type, void (*free_it)(Type*)>
using Owned = std::unique_ptr<Type, Freed<Type, free_it>>;

using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, gpiod_request_config_free>;
using LineInfo = Owned<gpiod_line_info, gpiod_line_info_free>;
using ChipInfo = Owned<gpiod_chip_info, gpiod_chip_info_free>;
using Events = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;
using Request = Owned<gpiod_line_request, gpiod_line_request_release>;

using Levels = std::array<gpiod_line_value, kMaxGpioLines>;

gpiod_line_value valueOf(bool level) {
  return level ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

/// Fails only for values that there are none of, or out of memory.
void setDirection(gpiod_line_settings* settings, GpioDirection direction, bool level,
                  bool is_pulled) {
  if (direction == GpioDirection::kOutput) {
    gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_OUTPUT);
    gpiod_line_settings_set_output_value(settings, valueOf(level));
    return;
  }
  gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT);
  if (is_pulled)
    gpiod_line_settings_set_bias(settings,
                                 level ? GPIOD_LINE_BIAS_PULL_UP : GPIOD_LINE_BIAS_PULL_DOWN);
  if (direction == GpioDirection::kInputWithEdges)
    gpiod_line_settings_set_edge_detection(settings, GPIOD_LINE_EDGE_BOTH);
}

class RequestV2 final : public GpioRequest {
 public:
  RequestV2(Request request, Events events)
      : request_(std::move(request)), events_(std::move(events)) {}

  bool read(std::span<bool> levels) noexcept override {
    Levels values{};
    if (gpiod_line_request_get_values(request_.get(), values.data()) != 0) return false;
    for (std::size_t i = 0; i < levels.size(); ++i)
      levels[i] = values[i] == GPIOD_LINE_VALUE_ACTIVE;
    return true;
  }

  bool write(std::span<const bool> levels) noexcept override {
    Levels values{};
    for (std::size_t i = 0; i < levels.size(); ++i) values[i] = valueOf(levels[i]);
    return gpiod_line_request_set_values(request_.get(), values.data()) == 0;
  }

  bool readEdges(GpioEdges& edges) noexcept override {
    const int count =
        gpiod_line_request_read_edge_events(request_.get(), events_.get(), kMaxGpioEdges);
    for (int i = 0; i < count; ++i) {
      gpiod_edge_event* const event =
          gpiod_edge_event_buffer_get_event(events_.get(), static_cast<unsigned long>(i));
      const gpiod_edge_event_type type = gpiod_edge_event_get_event_type(event);
      edges.has_risen |= type == GPIOD_EDGE_EVENT_RISING_EDGE;
      edges.has_fallen |= type == GPIOD_EDGE_EVENT_FALLING_EDGE;
    }
    return count >= 0 || errno == EAGAIN;
  }

 private:
  Request request_;
  Events events_;  ///< room for those of one cycle; nullptr: no edges
};

class ChipV2 final : public GpioChip {
 public:
  explicit ChipV2(gpiod_chip* chip) : chip_(chip) {}
  ~ChipV2() override { gpiod_chip_close(chip_); }
  ChipV2(const ChipV2&) = delete;
  ChipV2& operator=(const ChipV2&) = delete;

  int lineCount() override {
    const ChipInfo info(gpiod_chip_get_info(chip_));
    return info ? static_cast<int>(gpiod_chip_info_get_num_lines(info.get())) : 0;
  }

  std::optional<std::string> user(int line) override {
    const LineInfo info(gpiod_chip_get_line_info(chip_, static_cast<unsigned>(line)));
    if (!info || !gpiod_line_info_is_used(info.get())) return std::nullopt;
    const char* const name = gpiod_line_info_get_consumer(info.get());
    return name == nullptr ? "the kernel" : name;
  }

  std::unique_ptr<GpioRequest> request(const std::vector<int>& lines, GpioDirection direction,
                                       std::span<const bool> levels) override {
    auto request = requestLines(lines, direction, levels, true);
    if (!request && mayLackPull(direction)) request = requestLines(lines, direction, levels, false);
    return request;
  }

 private:
  std::unique_ptr<GpioRequest> requestLines(const std::vector<int>& lines, GpioDirection direction,
                                            std::span<const bool> levels, bool is_pulled) {
    const Settings settings(gpiod_line_settings_new());
    const LineConfig config(gpiod_line_config_new());
    const RequestConfig ours(gpiod_request_config_new());
    if (!settings || !config || !ours) return nullptr;
    gpiod_request_config_set_consumer(ours.get(), kGpioConsumer);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      setDirection(settings.get(), direction, levels[i], is_pulled);
      const unsigned offset = static_cast<unsigned>(lines[i]);
      if (gpiod_line_config_add_line_settings(config.get(), &offset, 1, settings.get()) != 0)
        return nullptr;
    }
    Request request(gpiod_chip_request_lines(chip_, ours.get(), config.get()));
    if (!request) return nullptr;
    Events events;
    if (direction == GpioDirection::kInputWithEdges) {
      events.reset(gpiod_edge_event_buffer_new(kMaxGpioEdges));
      const int descriptor = gpiod_line_request_get_fd(request.get());
      if (!events || fcntl(descriptor, F_SETFL, O_NONBLOCK) != 0) return nullptr;
    }
    return std::make_unique<RequestV2>(std::move(request), std::move(events));
  }

  gpiod_chip* chip_;
};

}  // namespace

std::unique_ptr<GpioChip> findGpioChip(const std::string& name) {
  gpiod_chip* const chip = gpiod_chip_open(("/dev/" + name).c_str());
  if (chip == nullptr) return nullptr;
  return std::make_unique<ChipV2>(chip);
}

}  // namespace tactus
