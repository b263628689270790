#include "tactus/io/gpio_lines.h"

#include <errno.h>

#include <array>
#include <cstring>
#include <string>

#include "gpio_chip.h"
#include "tactus/canopen/cycle_count.h"
#include "tactus/io/debounce.h"

namespace tactus {
namespace {

/// Lines that are read or written by one call, each tied to the variable that holds its level.
class LineGroup {
 public:
  void add(const GpioLineConfig& line, bool& is_active) {
    members_[numbers_.size()] = {line.active_low, &is_active};
    numbers_.push_back(line.line);
  }

  /// Outputs begin with their variables' levels; an input whose wire is gone shall read as its
  /// variable is now. False: errno tells why.
  bool request(GpioChip& chip, GpioDirection direction) {
    if (numbers_.empty()) return true;
    const Levels levels = levelsToWrite();
    request_ = chip.request(numbers_, direction, levels);
    return request_ != nullptr;
  }

  /// False: the chip refuses, and the variables stay.
  bool read() noexcept {
    Levels levels{};
    if (!request_) return true;
    if (!request_->read(std::span(levels).first(numbers_.size()))) return false;
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      *members_[i].is_active = levels[i] != members_[i].is_active_low;
    return true;
  }

  bool write() noexcept {
    const Levels levels = levelsToWrite();
    return !request_ || request_->write(std::span(levels).first(numbers_.size()));
  }

  /// Whether the first line became active and may be inactive again.
  bool readEdges(bool& was_active) noexcept {
    GpioEdges edges;
    const bool is_read = request_->readEdges(edges);
    if (members_[0].is_active_low ? edges.has_fallen : edges.has_risen) was_active = true;
    return is_read;
  }

  std::string numbers() const {
    std::string text;
    for (const int number : numbers_) text += (text.empty() ? "" : ", ") + std::to_string(number);
    return text;
  }

 private:
  using Levels = std::array<bool, kMaxGpioLines>;

  struct Member {
    bool is_active_low = false;
    bool* is_active = nullptr;
  };

  Levels levelsToWrite() const noexcept {
    Levels levels{};
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      levels[i] = *members_[i].is_active != members_[i].is_active_low;
    return levels;
  }

  std::vector<int> numbers_;
  std::array<Member, kMaxGpioLines> members_;
  std::unique_ptr<GpioRequest> request_;
};

}  // namespace

struct GpioLines::Lines {
  Lines(const GpioConfig& config, double period_s);
  ~Lines();

  void add(LineGroup& group, const std::optional<GpioLineConfig>& line, bool& is_active);
  void requestEmergencyStop(const GpioLineConfig& line);
  void request(LineGroup& group, GpioDirection direction);
  bool drainEdges(bool& was_pressed) noexcept;

  std::string name;
  std::unique_ptr<GpioChip> chip;  ///< outlives what was requested of it
  LineGroup stop;                  ///< alone, as a line with events needs a request of its own
  LineGroup inputs;                ///< the others
  LineGroup outputs;
  bool sees_edges = false;
  bool is_stop_pressed = false;
  bool is_enabled = true;
  bool is_brake_released = false;
  bool is_heartbeat_high = false;
  Debounce debounced_stop{0, 0, false};
  Debounce debounced_enable{0, 0, true};
};

GpioLines::Lines::Lines(const GpioConfig& config, double period_s)
    : name(config.chip), chip(openGpioChip(config.chip)) {
  is_stop_pressed = config.e_stop.has_value();  // as they read without their wires
  is_enabled = !config.enable.has_value();
  if (config.e_stop) requestEmergencyStop(*config.e_stop);
  add(inputs, config.enable, is_enabled);
  add(outputs, config.brake, is_brake_released);
  add(outputs, config.heartbeat, is_heartbeat_high);
  request(inputs, GpioDirection::kInput);
  request(outputs, GpioDirection::kOutput);
  if (!stop.read() || !inputs.read())
    failOnChip(name, std::string("cannot be read: ") + std::strerror(errno));
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
  requireGpioLine(*chip, name, line->line);
  group.add(*line, is_active);
}

/// With edge events if the chip has them, else polled like any input.
void GpioLines::Lines::requestEmergencyStop(const GpioLineConfig& line) {
  add(stop, line, is_stop_pressed);
  sees_edges = stop.request(*chip, GpioDirection::kInputWithEdges);
  if (!sees_edges) request(stop, GpioDirection::kInput);
}

void GpioLines::Lines::request(LineGroup& group, GpioDirection direction) {
  if (!group.request(*chip, direction))
    failOnChip(name, "cannot request line " + group.numbers() + ": " + std::strerror(errno) +
                         "; gpioinfo shows who uses it");
}

bool GpioLines::Lines::drainEdges(bool& was_pressed) noexcept {
  return !sees_edges || stop.readEdges(was_pressed);
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
          .is_enable_off = !lines_->is_enabled,
          .is_valid = has_edges && has_stop && has_inputs};
}

bool GpioLines::write(const GpioOutputs& outputs) noexcept {
  lines_->is_brake_released = outputs.release_brake;
  lines_->is_heartbeat_high = outputs.heartbeat;
  return lines_->outputs.write();
}

bool GpioLines::seesPulses() const noexcept { return lines_->sees_edges; }

}  // namespace tactus
