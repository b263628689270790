#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tactus/supervisor/brake.h"
#include "tactus/supervisor/mode.h"

/// One cycle of modes and brakes over every input, with time limits of a few cycles.
namespace tactus::test {

inline constexpr ModeConfig kWalkModes{.boot_cycles = 3,
                                       .enabling_cycles = 4,
                                       .retreating_cycles = 3,
                                       .stopping_cycles = 5,
                                       .brake_cycles = 1};
inline constexpr BrakeConfig kWalkBrakes{.rest_cycles = 1, .deadline_cycles = 2};
inline constexpr int kWalkLongest_cycles = 7;  ///< cycles in a mode; more make no difference
/// While a hold or a stop ramps: set by the acceleration limits.
inline constexpr int kWalkRamp_cycles = 2;

struct WalkState {
  ModeState mode;
  BrakeState brake;
  bool was_off = false;  ///< the enable line, since the last fault or hold: what may_clear means

  auto key() const {
    return std::array{static_cast<int>(mode.mode),
                      static_cast<int>(mode.fault),
                      static_cast<int>(mode.reaction),
                      static_cast<int>(mode.may_clear),
                      mode.cycles_in_mode,
                      mode.enabled_cycles,
                      static_cast<int>(brake.is_open),
                      brake.rest_cycles,
                      static_cast<int>(was_off)};
  }
};

struct WalkInput {
  ModeInput mode;
  BrakeInput brake;
};

/// What a cycle may be told, each bit of one thing.
inline constexpr unsigned kWalkInputBits = 11;
inline constexpr int kWalkMissed_cycles = 2;  ///< where some were missed

inline WalkInput walkInput(Fault fault, unsigned bits, bool has_enable_line) {
  const auto bit = [bits](int i) { return (bits >> i & 1U) != 0; };
  WalkInput input;
  input.mode.fault = fault;
  input.mode.has_enable_line = has_enable_line;
  input.mode.enable = bit(0) || !has_enable_line;
  input.mode.stop_requested = bit(1);
  input.mode.are_configured = bit(2);
  input.mode.are_enabled = input.brake.are_enabled = bit(3);
  input.mode.are_disabled = bit(4);
  input.mode.is_at_rest = bit(5);
  input.brake.is_at_rest = bit(6);
  input.brake.is_any_holding = bit(7);
  input.brake.is_any_moving_on = bit(8);
  input.mode.is_retreat_over = bit(9);
  input.mode.missed_cycles = bit(10) ? kWalkMissed_cycles : 0;
  return input;
}

/// All that drives, lines and buses may say at once; a drive that holds is not off.
inline std::vector<WalkInput> walkInputs(bool has_enable_line) {
  std::vector<WalkInput> inputs;
  for (const FaultRow& row : faultTable()) {
    for (unsigned bits = 0; bits < 1U << kWalkInputBits; ++bits) {
      const WalkInput input = walkInput(row.fault, bits, has_enable_line);
      const bool is_idle_bit = !has_enable_line && (bits & 1U) != 0;
      if (is_idle_bit || (input.mode.are_disabled && input.brake.is_any_holding)) continue;
      inputs.push_back(input);
    }
  }
  return inputs;
}

/// Where a stop has a deadline of time.
inline bool countsMissedCycles(Mode mode) {
  return mode == Mode::kRetreating || mode == Mode::kStopping || mode == Mode::kFault;
}

/// The arm rests before it may move, and after its ramp. Cycles may be missed anywhere; where that
/// counts for nothing, it need not be walked.
inline bool canHappen(const WalkState& state, const WalkInput& input) {
  const ModeState& mode = state.mode;
  const bool is_ramping = (mode.mode == Mode::kHolding || mode.mode == Mode::kStopping) &&
                          mode.cycles_in_mode < kWalkRamp_cycles;
  const bool may_move = mode.mode == Mode::kRunning || mode.mode == Mode::kRetreating || is_ramping;
  return (may_move || input.mode.is_at_rest) &&
         (input.mode.missed_cycles == 0 || countsMissedCycles(mode.mode));
}

inline WalkState walkOn(const WalkState& before, const WalkInput& input) {
  WalkState state = before;
  updateMode(kWalkModes, input.mode, state.mode);
  state.mode.cycles_in_mode = std::min(state.mode.cycles_in_mode, kWalkLongest_cycles);
  updateBrake(kWalkBrakes, state.mode, input.brake, state.brake);
  const bool is_new_fault = input.mode.fault != Fault::kNone ||
                            (before.mode.fault == Fault::kNone && state.mode.fault != Fault::kNone);
  if (is_new_fault || state.mode.mode == Mode::kRunning) state.was_off = false;
  if (!input.mode.enable && input.mode.fault == Fault::kNone) state.was_off = true;
  return state;
}

}  // namespace tactus::test
