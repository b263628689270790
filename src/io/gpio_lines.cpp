#include "tactus/io/gpio_lines.h"

#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>

#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

#include "tactus/io/cycle_count.h"
#include "tactus/io/debounce.h"

namespace tactus {
namespace {

constexpr const char* kConsumer = "tactusd";  ///< as gpioinfo shows it
constexpr unsigned kMaxEvents = 16;           ///< read a cycle: as many as the kernel keeps

using Chip = std::unique_ptr<gpiod_chip, decltype(&gpiod_chip_close)>;

[[noreturn]] void fail(const std::string& chip, const std::string& problem) {
  throw std::runtime_error(chip + ": " + problem);
}

Chip openChip(const std::string& name) {
  Chip chip(gpiod_chip_open_by_name(name.c_str()), &gpiod_chip_close);
  if (!chip)
    fail(name, std::string("cannot open this GPIO chip (") + std::strerror(errno) +
                   "); gpiodetect lists the chips, and the user needs access to /dev/" + name);
  return chip;
}

/// Lines that are read or written by one call, each tied to the variable that holds its level.
class LineGroup {
 public:
  LineGroup() { gpiod_line_bulk_init(&bulk_); }

  void add(gpiod_line* line, bool is_active_low, bool& is_active) {
    members_[size()] = {is_active_low, &is_active};
    gpiod_line_bulk_add(&bulk_, line);
  }

  /// Outputs begin with their variables' levels. False: errno tells why.
  bool request(int type) {
    const gpiod_line_request_config request{kConsumer, type, 0};
    const Levels levels = levelsToWrite();
    return size() == 0 || gpiod_line_request_bulk(&bulk_, &request, levels.data()) == 0;
  }

  /// False: the chip refuses, and the variables stay.
  bool read() noexcept {
    Levels levels{};
    if (size() == 0) return true;
    if (gpiod_line_get_value_bulk(&bulk_, levels.data()) != 0) return false;
    for (unsigned i = 0; i < size(); ++i)
      *members_[i].is_active = (levels[i] != 0) != members_[i].is_active_low;
    return true;
  }

  bool write() noexcept {
    const Levels levels = levelsToWrite();
    return size() == 0 || gpiod_line_set_value_bulk(&bulk_, levels.data()) == 0;
  }

  std::string numbers() {
    std::string text;
    for (unsigned i = 0; i < size(); ++i)
      text += (i == 0 ? "" : ", ") +
              std::to_string(gpiod_line_offset(gpiod_line_bulk_get_line(&bulk_, i)));
    return text;
  }

 private:
  static constexpr unsigned kMaxLines = 2;
  using Levels = std::array<int, kMaxLines>;

  struct Member {
    bool is_active_low = false;
    bool* is_active = nullptr;
  };

  unsigned size() noexcept { return gpiod_line_bulk_num_lines(&bulk_); }

  Levels levelsToWrite() noexcept {
    Levels levels{};
    for (unsigned i = 0; i < size(); ++i)
      levels[i] = *members_[i].is_active != members_[i].is_active_low;
    return levels;
  }

  gpiod_line_bulk bulk_;
  std::array<Member, kMaxLines> members_;
};

}  // namespace

struct GpioLines::Lines {
  Lines(const GpioConfig& config, double period_s);
  ~Lines();

  void add(LineGroup& group, const std::optional<GpioLineConfig>& line, bool& is_active);
  void requestEmergencyStop(const GpioLineConfig& line);
  void request(LineGroup& group, int type);
  bool drainEdges(bool& was_pressed) noexcept;

  std::string name;
  Chip chip;
  LineGroup stop;  ///< alone, as a line with events needs a request of its own
  LineGroup inputs;
  LineGroup outputs;
  int stop_events = -1;  ///< descriptor; -1: the e-stop is among the inputs, if there is one
  int press_event = GPIOD_LINE_EVENT_RISING_EDGE;
  bool is_stop_pressed = false;
  bool is_enabled = true;
  bool is_brake_released = false;
  bool is_heartbeat_high = false;
  Debounce debounced_stop{0, 0, false};
  Debounce debounced_enable{0, 0, true};
};

GpioLines::Lines::Lines(const GpioConfig& config, double period_s)
    : name(config.chip), chip(openChip(config.chip)) {
  if (config.e_stop) requestEmergencyStop(*config.e_stop);
  add(inputs, config.enable, is_enabled);
  add(outputs, config.brake, is_brake_released);
  add(outputs, config.heartbeat, is_heartbeat_high);
  request(inputs, GPIOD_LINE_REQUEST_DIRECTION_INPUT);
  request(outputs, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT);
  if (!stop.read() || !inputs.read()) fail(name, std::string("cannot be read: ") + strerror(errno));
  if (config.e_stop)
    debounced_stop =
        Debounce(0, cyclesCovering(config.e_stop->debounce_s, period_s), is_stop_pressed);
  if (config.enable)
    debounced_enable = Debounce(cyclesCovering(config.enable->debounce_s, period_s), 0, is_enabled);
}

GpioLines::Lines::~Lines() {
  is_brake_released = is_heartbeat_high = false;
  outputs.write();
}

void GpioLines::Lines::add(LineGroup& group, const std::optional<GpioLineConfig>& line,
                           bool& is_active) {
  if (!line) return;
  gpiod_line* found = gpiod_chip_get_line(chip.get(), static_cast<unsigned>(line->line));
  if (found == nullptr)
    fail(name, "has no line " + std::to_string(line->line) + ", expected 0 to " +
                   std::to_string(gpiod_chip_num_lines(chip.get()) - 1));
  group.add(found, line->active_low, is_active);
}

/// With edge events if the chip has them, else polled like any input.
void GpioLines::Lines::requestEmergencyStop(const GpioLineConfig& line) {
  add(stop, line, is_stop_pressed);
  if (!stop.request(GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES)) {
    stop = LineGroup();
    add(inputs, line, is_stop_pressed);
    return;
  }
  if (line.active_low) press_event = GPIOD_LINE_EVENT_FALLING_EDGE;
  stop_events =
      gpiod_line_event_get_fd(gpiod_chip_get_line(chip.get(), static_cast<unsigned>(line.line)));
  if (stop_events < 0 || fcntl(stop_events, F_SETFL, O_NONBLOCK) != 0)
    fail(name, std::string("cannot watch the e-stop's edges: ") + std::strerror(errno));
}

void GpioLines::Lines::request(LineGroup& group, int type) {
  if (!group.request(type))
    fail(name, "cannot request line " + group.numbers() + ": " + std::strerror(errno) +
                   "; gpioinfo shows who uses it");
}

bool GpioLines::Lines::drainEdges(bool& was_pressed) noexcept {
  if (stop_events < 0) return true;
  std::array<gpiod_line_event, kMaxEvents> events;
  const int count = gpiod_line_event_read_fd_multiple(stop_events, events.data(), kMaxEvents);
  for (int i = 0; i < count; ++i) {
    if (events[i].event_type == press_event) was_pressed = true;
  }
  return count >= 0 || errno == EAGAIN;
}

GpioLines::GpioLines(const GpioConfig& config, double period_s)
    : lines_(std::make_unique<Lines>(config, period_s)) {}

GpioLines::~GpioLines() = default;

GpioInputs GpioLines::read() noexcept {
  bool was_pressed = false;
  const bool has_edges = lines_->drainEdges(was_pressed);
  const bool has_stop = lines_->stop.read();
  const bool has_inputs = lines_->inputs.read();
  const bool is_stop_pressed = lines_->is_stop_pressed || was_pressed;
  return {.emergency_stop = lines_->debounced_stop.update(is_stop_pressed),
          .enable = lines_->debounced_enable.update(lines_->is_enabled),
          .is_valid = has_edges && has_stop && has_inputs};
}

bool GpioLines::write(const GpioOutputs& outputs) noexcept {
  lines_->is_brake_released = outputs.release_brake;
  lines_->is_heartbeat_high = outputs.heartbeat;
  return lines_->outputs.write();
}

bool GpioLines::seesPulses() const noexcept { return lines_->stop_events >= 0; }

}  // namespace tactus
