#pragma once

namespace tactus {

/// Inputs after polarity and debounce. Lines that the robot does not have read as here.
struct GpioInputs {
  bool emergency_stop = false;
  bool enable = true;
  bool is_enable_off = false;  ///< as it was read, for however short
  bool must_go_off = false;  ///< the enable line is on, and counts once it was off: see EnableWait
  bool is_valid = true;      ///< false: the chip could not be read
};

struct GpioOutputs {
  bool release_brake = false;
  bool heartbeat = false;
};

}  // namespace tactus
