#include "tactus/plant/power_state.h"

namespace tactus {

PowerState commanded(PowerState state, std::uint16_t control_word, bool is_reset_edge) noexcept {
  const bool switch_on = (control_word & 1) != 0;
  const bool has_voltage = (control_word & 2) != 0;
  const bool no_quick_stop = (control_word & 4) != 0;
  const bool enable = (control_word & 8) != 0;
  switch (state) {
    case PowerState::kSwitchOnDisabled:
      return has_voltage && no_quick_stop && !switch_on ? PowerState::kReadyToSwitchOn : state;
    case PowerState::kReadyToSwitchOn:
      if (!has_voltage || !no_quick_stop) return PowerState::kSwitchOnDisabled;
      return switch_on ? PowerState::kSwitchedOn : state;
    case PowerState::kSwitchedOn:
      if (!has_voltage || !no_quick_stop) return PowerState::kSwitchOnDisabled;
      if (!switch_on) return PowerState::kReadyToSwitchOn;
      return enable ? PowerState::kOperationEnabled : state;
    case PowerState::kOperationEnabled:
      if (!has_voltage) return PowerState::kSwitchOnDisabled;
      if (!no_quick_stop) return PowerState::kQuickStopActive;
      if (!switch_on) return PowerState::kReadyToSwitchOn;
      return enable ? state : PowerState::kSwitchedOn;
    case PowerState::kQuickStopActive:
      return has_voltage ? state : PowerState::kSwitchOnDisabled;
    case PowerState::kFault:
      return is_reset_edge ? PowerState::kSwitchOnDisabled : state;
    default:
      return state;
  }
}

bool hasTorque(PowerState state) noexcept {
  return state == PowerState::kOperationEnabled || state == PowerState::kQuickStopActive ||
         state == PowerState::kFaultReactionActive;
}

PowerState atStandstill(PowerState state) noexcept {
  if (state == PowerState::kQuickStopActive) return PowerState::kSwitchOnDisabled;
  if (state == PowerState::kFaultReactionActive) return PowerState::kFault;
  return state;
}

std::uint16_t stateBits(PowerState state) noexcept {
  switch (state) {
    case PowerState::kNotReadyToSwitchOn:
      return 0x00;
    case PowerState::kSwitchOnDisabled:
      return 0x40;
    case PowerState::kReadyToSwitchOn:
      return 0x21;
    case PowerState::kSwitchedOn:
      return 0x23;
    case PowerState::kOperationEnabled:
      return 0x27;
    case PowerState::kQuickStopActive:
      return 0x07;
    case PowerState::kFaultReactionActive:
      return 0x0F;
    case PowerState::kFault:
      return 0x08;
  }
  return 0x00;
}

}  // namespace tactus
