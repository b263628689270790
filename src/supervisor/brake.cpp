#include "tactus/supervisor/brake.h"

#include <algorithm>

#include "tactus/supervisor/mode_table.h"

namespace tactus {
namespace {

std::uint32_t brakeConditions(const BrakeConfig& config, const ModeState& mode,
                              const BrakeInput& input, const BrakeState& state) noexcept {
  const auto only = [](bool is, std::uint32_t yes) { return is ? yes : 0; };
  return only(state.is_open, kIfBrakeWasOpen) | only(input.are_enabled, kIfAllFollow) |
         only(state.rest_cycles == 0, kIfNotResting) | only(input.is_any_holding, kIfAnyHolds) |
         only(!input.is_any_moving_on, kIfNoneMovesOn) |
         only(mode.cycles_in_mode < config.deadline_cycles, kIfBeforeDeadline);
}

bool mayBeOpen(const BrakeConfig& config, const ModeState& mode, const BrakeInput& input,
               const BrakeState& state) noexcept {
  if (mode.reaction == Reaction::kBrake) return false;
  const std::uint32_t held = brakeConditions(config, mode, input, state);
  return std::any_of(brakeRows().begin(), brakeRows().end(), [&](const BrakeRow& row) {
    return row.mode == mode.mode && (row.conditions & held) == row.conditions;
  });
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
