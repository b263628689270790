#pragma once

#include <cstdint>

namespace tactus {

/// States of a drive's power stage (CiA 402).
enum class PowerState : std::uint8_t {
  kNotReadyToSwitchOn,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};

/// The state that a control word leads to, by one transition at most. Fault reset counts only as a
/// rising edge of bit 7.
PowerState commanded(PowerState state, std::uint16_t control_word, bool is_reset_edge) noexcept;

/// A drive in the other states holds nothing: what moves rolls on.
bool hasTorque(PowerState state) noexcept;

/// The state that follows once a stop has come to its end.
PowerState atStandstill(PowerState state) noexcept;

/// Bits 0 to 6 of the status word; bit 4, voltage, is the drive's.
std::uint16_t stateBits(PowerState state) noexcept;

}  // namespace tactus
