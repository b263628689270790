#include "tactus/supervisor/brake.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tactus {
namespace {

constexpr BrakeConfig kBrakeTimes{.rest_cycles = 3, .deadline_cycles = 5};

BrakeInput brakeBits(int bits) {
  return {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0};
}

/// In words of docs/safety.md: what an arm needs for its brakes to be open in this cycle.
bool mayHoldOpen(const ModeState& mode, const BrakeInput& input, bool was_open) {
  if (mode.reaction == Reaction::kBrake) return false;
  switch (mode.mode) {
    case Mode::kEnabling:
      return input.are_enabled;
    case Mode::kRunning:
    case Mode::kRetreating:
    case Mode::kHolding:
      return true;
    case Mode::kStopping:
      return was_open && !input.is_at_rest;
    case Mode::kFault:
      return was_open && input.is_any_holding && !input.is_any_moving_on &&
             mode.cycles_in_mode < kBrakeTimes.deadline_cycles;
    default:
      return false;
  }
}

TEST(Brake, IsOpenWhereAModeNeedsItAndNowhereElse) {
  for (int mode = 0; mode < kModeCount; ++mode)
    for (const Reaction reaction : {Reaction::kNone, Reaction::kRetreat, Reaction::kRamp,
                                    Reaction::kQuickStop, Reaction::kBrake})
      for (const int cycles : {0, 4, 5, 6})
        for (const bool was_open : {false, true})
          for (int bits = 0; bits < 16; ++bits) {
            ModeState state;
            state.mode = static_cast<Mode>(mode);
            state.reaction = reaction;
            state.cycles_in_mode = cycles;
            BrakeState brake{was_open, 0};
            updateBrake(kBrakeTimes, state, brakeBits(bits), brake);
            ASSERT_EQ(brake.is_open, mayHoldOpen(state, brakeBits(bits), was_open))
                << modeName(state.mode) << ", bits " << bits << ", cycle " << cycles;
          }
}

/// Drives hold the arm until brakes have closed: they let go after as many cycles at rest in a row
/// while it stops, whatever was before, and keep to that however long it rests.
TEST(Brake, LetsDrivesGoOnceItHasHadItsTimeAtRest) {
  test::Random random(2111);
  BrakeState brake;
  int at_rest = 0;
  for (int i = 0; i < 20000; ++i) {
    ModeState state;
    state.mode = random.chance(0.05) ? Mode::kHolding : Mode::kStopping;
    BrakeInput input;
    input.is_at_rest = random.chance(0.9);
    updateBrake(kBrakeTimes, state, input, brake);
    at_rest = state.mode == Mode::kStopping && input.is_at_rest ? at_rest + 1 : 0;
    ASSERT_EQ(mayLetGo(kBrakeTimes, brake), at_rest > kBrakeTimes.rest_cycles) << i;
    ASSERT_LE(brake.rest_cycles, kBrakeTimes.rest_cycles + 1) << "it counts without an end";
  }
}

}  // namespace
}  // namespace tactus
