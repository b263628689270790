#pragma once

#include <memory>

#include "tactus/io/hardware_config.h"

namespace tactus {

/// Inputs after polarity and debounce. Lines that the robot does not have read as here.
struct GpioInputs {
  bool emergency_stop = false;
  bool enable = true;
  bool is_valid = true;  ///< false: the chip could not be read
};

struct GpioOutputs {
  bool release_brake = false;
  bool heartbeat = false;
};

/// The robot's GPIO lines, through libgpiod. All requested together; outputs start inactive and are
/// made inactive when the object goes.
class GpioLines {
 public:
  /// Throws std::runtime_error naming chip, line and what to do.
  GpioLines(const GpioConfig& config, double period_s);
  ~GpioLines();

  GpioInputs read() noexcept;  ///< an edge between two cycles counts as active for the e-stop
  bool write(const GpioOutputs& outputs) noexcept;  ///< false: could not be written

 private:
  struct Lines;
  std::unique_ptr<Lines> lines_;
};

}  // namespace tactus
