#include "tactus/supervisor/brake.h"

#include <algorithm>

namespace tactus {
namespace {

bool mayBeOpen(const BrakeConfig& config, const ModeState& mode, const BrakeInput& input,
               const BrakeState& state) noexcept {
  if (mode.reaction == Reaction::kBrake) return false;
  switch (mode.mode) {
    case Mode::kEnabling:
      return input.are_enabled;
    case Mode::kRunning:
    case Mode::kRetreating:
    case Mode::kHolding:
      return true;
    case Mode::kStopping:
      return state.is_open && state.rest_cycles == 0;
    case Mode::kFault:
      return state.is_open && input.is_any_holding && !input.is_any_moving_on &&
             mode.cycles_in_mode < config.deadline_cycles;
    default:
      return false;
  }
}

}  // namespace

void updateBrake(const BrakeConfig& config, const ModeState& mode, const BrakeInput& input,
                 BrakeState& state) noexcept {
  const bool is_resting = mode.mode == Mode::kStopping && input.is_at_rest;
  state.rest_cycles = is_resting ? std::min(state.rest_cycles, config.rest_cycles) + 1 : 0;
  state.is_open = mayBeOpen(config, mode, input, state);
}

bool mayLetGo(const BrakeConfig& config, const BrakeState& state) noexcept {
  return state.rest_cycles > config.rest_cycles;
}

}  // namespace tactus
