#pragma once

#include <memory>

#include "tactus/canopen/hardware_config.h"
#include "tactus/supervisor/line_states.h"

namespace tactus {

/// The robot's GPIO lines, through libgpiod. All requested together; outputs start inactive and are
/// made inactive when the object goes. What a line does once its owner has gone is up to the chip:
/// pull it to its safe level outside.
///
/// An e-stop that is pressed and an enable that is switched off act at once; the other way round
/// they have to last for debounce_s. System calls: read() takes one ioctl, or where the chip
/// reports the e-stop's edges two ioctls (e-stop and enable) and one read; write() one ioctl. Lines
/// that the robot does not have cost none.
class GpioLines {
 public:
  /// Throws std::runtime_error naming chip, line and what to do.
  GpioLines(const GpioConfig& config, double period_s);
  ~GpioLines();

  /// Once a cycle. An edge between two cycles counts as active for the e-stop. What cannot be read
  /// keeps its last value and is_valid tells.
  GpioInputs read() noexcept;
  bool write(const GpioOutputs& outputs) noexcept;  ///< false: could not be written
  /// Whether a pulse of the e-stop that is shorter than a cycle is seen.
  bool seesPulses() const noexcept;

 private:
  struct Lines;
  std::unique_ptr<Lines> lines_;
};

}  // namespace tactus
