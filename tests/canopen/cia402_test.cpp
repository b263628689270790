#include "tactus/canopen/cia402.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "support/random.h"

namespace tactus {
namespace {

const std::vector<DriveState> kAllStates = {DriveState::kNotReady,
                                            DriveState::kSwitchOnDisabled,
                                            DriveState::kReadyToSwitchOn,
                                            DriveState::kSwitchedOn,
                                            DriveState::kOperationEnabled,
                                            DriveState::kQuickStopActive,
                                            DriveState::kFaultReactionActive,
                                            DriveState::kFault};

/// The table of CiA 402-2 as it is printed, bit 15 first.
struct Pattern {
  std::string bits;
  DriveState state;
};
const std::vector<Pattern> kPrinted = {
    {"xxxxxxxxx0xx0000", DriveState::kNotReady},
    {"xxxxxxxxx1xx0000", DriveState::kSwitchOnDisabled},
    {"xxxxxxxxx01x0001", DriveState::kReadyToSwitchOn},
    {"xxxxxxxxx01x0011", DriveState::kSwitchedOn},
    {"xxxxxxxxx01x0111", DriveState::kOperationEnabled},
    {"xxxxxxxxx00x0111", DriveState::kQuickStopActive},
    {"xxxxxxxxx0xx1111", DriveState::kFaultReactionActive},
    {"xxxxxxxxx0xx1000", DriveState::kFault},
};

std::optional<DriveState> printedState(unsigned status_word) {
  std::optional<DriveState> found;
  for (const Pattern& pattern : kPrinted) {
    bool fits = true;
    for (int bit = 0; bit < 16; ++bit) {
      const char wanted = pattern.bits[15 - bit];
      const char is = (status_word >> bit & 1u) != 0 ? '1' : '0';
      fits = fits && (wanted == 'x' || wanted == is);
    }
    if (!fits) continue;
    EXPECT_FALSE(found.has_value()) << "two patterns fit " << status_word;
    found = pattern.state;
  }
  return found;
}

TEST(StatusWord, IsDecodedAsPrintedForAllValues) {
  int known = 0;
  for (unsigned word = 0; word < 65536; ++word) {
    const auto expected = printedState(word);
    known += expected.has_value();
    ASSERT_EQ(decodeStatusWord(static_cast<std::uint16_t>(word)), expected) << word;
  }
  // 4 patterns with 5 of 16 bits fixed, 4 with 6.
  EXPECT_EQ(known, 4 * 2048 + 4 * 1024);
}

TEST(PowerTable, HoldsTheTransitionsOfTheStandardByNumber) {
  using enum DriveState;
  const std::vector<std::pair<std::optional<DriveState>, DriveState>> expected = {
      {std::nullopt, kNotReady},
      {kNotReady, kSwitchOnDisabled},
      {kSwitchOnDisabled, kReadyToSwitchOn},
      {kReadyToSwitchOn, kSwitchedOn},
      {kSwitchedOn, kOperationEnabled},
      {kOperationEnabled, kSwitchedOn},
      {kSwitchedOn, kReadyToSwitchOn},
      {kReadyToSwitchOn, kSwitchOnDisabled},
      {kOperationEnabled, kReadyToSwitchOn},
      {kOperationEnabled, kSwitchOnDisabled},
      {kSwitchedOn, kSwitchOnDisabled},
      {kOperationEnabled, kQuickStopActive},
      {kQuickStopActive, kSwitchOnDisabled},
      {std::nullopt, kFaultReactionActive},
      {kFaultReactionActive, kFault},
      {kFault, kSwitchOnDisabled},
      {kQuickStopActive, kOperationEnabled}};
  ASSERT_EQ(powerTransitions().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const PowerTransition& row = powerTransitions()[i];
    EXPECT_EQ(row.number, static_cast<int>(i));
    EXPECT_EQ(row.from, expected[i].first) << i;
    EXPECT_EQ(row.to, expected[i].second) << i;
    EXPECT_EQ(row.is_automatic, i == 0 || i == 1 || i == 12 || i == 13 || i == 14) << i;
  }
}

TEST(PowerTable, LeavesNoChoice) {
  for (DriveState state : kAllStates) {
    for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kEnabled, PowerGoal::kQuickStop}) {
      int rows = 0;
      for (const PowerTransition& row : powerTransitions()) {
        const bool serves = (goal == PowerGoal::kDisabled && row.to_disabled) ||
                            (goal == PowerGoal::kEnabled && row.to_enabled);
        rows += serves && row.from == state;
      }
      EXPECT_LE(rows, 1) << driveStateName(state);
      const PowerTransition* next = nextTransition(state, goal);
      EXPECT_EQ(next != nullptr, rows == 1);
    }
  }
}

/// It is left there, and its reaction is waited for, whatever is wanted of it.
TEST(PowerTable, LeadsNowhereFromAFault) {
  for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kEnabled, PowerGoal::kQuickStop}) {
    EXPECT_EQ(nextTransition(DriveState::kFault, goal), nullptr);
    EXPECT_EQ(nextTransition(DriveState::kFaultReactionActive, goal), nullptr);
  }
}

TEST(ControlWord, IsNeverAFaultResetNorAnUndefinedCommand) {
  for (DriveState state : kAllStates) {
    for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kEnabled, PowerGoal::kQuickStop}) {
      const int word = controlWordTowards(goal, state);
      EXPECT_TRUE(word == 0 || word == 2 || word == 6 || word == 7 || word == 15) << word;
    }
  }
}

TEST(ControlWord, DoesNotCutAStopShort) {
  for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kEnabled, PowerGoal::kQuickStop}) {
    EXPECT_EQ(controlWordTowards(goal, DriveState::kQuickStopActive) & 0x06, 0x02);
  }
  EXPECT_EQ(controlWordTowards(PowerGoal::kDisabled, DriveState::kOperationEnabled), 0x07);
  for (DriveState state : kAllStates)
    EXPECT_EQ(controlWordTowards(PowerGoal::kQuickStop, state), 0x02);
}

/// Commands by their bits, as CiA 402-2 prints them (bits 7, 3, 2, 1, 0).
DriveState answerTo(DriveState state, int word, bool auto_step) {
  using enum DriveState;
  switch (state) {
    case kNotReady:
      return auto_step ? kSwitchOnDisabled : state;
    case kSwitchOnDisabled:
      return (word & 0x87) == 0x06 ? kReadyToSwitchOn : state;
    case kReadyToSwitchOn:
      if ((word & 0x82) == 0x00 || (word & 0x86) == 0x02) return kSwitchOnDisabled;
      return (word & 0x87) == 0x07 ? kSwitchedOn : state;
    case kSwitchedOn:
      if ((word & 0x82) == 0x00 || (word & 0x86) == 0x02) return kSwitchOnDisabled;
      if ((word & 0x87) == 0x06) return kReadyToSwitchOn;
      return (word & 0x8F) == 0x0F ? kOperationEnabled : state;
    case kOperationEnabled:
      if ((word & 0x82) == 0x00) return kSwitchOnDisabled;
      if ((word & 0x86) == 0x02) return kQuickStopActive;
      if ((word & 0x87) == 0x06) return kReadyToSwitchOn;
      return (word & 0x8F) == 0x07 ? kSwitchedOn : state;
    case kQuickStopActive:
      if ((word & 0x82) == 0x00 || auto_step) return kSwitchOnDisabled;
      return (word & 0x8F) == 0x0F ? kOperationEnabled : state;
    case kFaultReactionActive:
      return auto_step ? kFault : state;
    case kFault:
      return state;
  }
  return state;
}

/// From every state the goal is reached and kept, whenever the drive takes its own steps; from a
/// fault it never is.
TEST(ControlWord, LeadsEveryStateToEveryGoal) {
  test::Random random(403);
  for (DriveState start : kAllStates) {
    for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kEnabled, PowerGoal::kQuickStop}) {
      for (int run = 0; run < 200; ++run) {
        DriveState state = start;
        const int first_auto_step = random.index(20);
        for (int step = 0; step < 30; ++step)
          state = answerTo(state, controlWordTowards(goal, state), step >= first_auto_step);
        const DriveState rest = goal == PowerGoal::kEnabled ? DriveState::kOperationEnabled
                                                            : DriveState::kSwitchOnDisabled;
        const bool was_faulty =
            start == DriveState::kFault || start == DriveState::kFaultReactionActive;
        ASSERT_EQ(state, was_faulty ? DriveState::kFault : rest)
            << driveStateName(start) << " to goal " << static_cast<int>(goal);
      }
    }
  }
}

TEST(ControlWord, NeverLeavesADriveEnabledLongerThanItsGoalAllows) {
  for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kQuickStop}) {
    const int word = controlWordTowards(goal, DriveState::kOperationEnabled);
    EXPECT_NE(answerTo(DriveState::kOperationEnabled, word, false), DriveState::kOperationEnabled);
    for (DriveState state : kAllStates) {
      if (state == DriveState::kOperationEnabled) continue;
      EXPECT_NE(answerTo(state, controlWordTowards(goal, state), true),
                DriveState::kOperationEnabled);
    }
  }
}

/// Step by step, whoever asks for the next one gets there.
TEST(PowerTable, LeadsEveryStateButFaultsToItsGoal) {
  using enum DriveState;
  for (const auto& [goal, end] : {std::pair{PowerGoal::kEnabled, kOperationEnabled},
                                  {PowerGoal::kDisabled, kSwitchOnDisabled}}) {
    for (DriveState state : kAllStates) {
      if (state == kFault || state == kFaultReactionActive) continue;
      int steps = 0;
      for (; steps < 10; ++steps) {
        const PowerTransition* const next = nextTransition(state, goal);
        if (next == nullptr) break;
        EXPECT_EQ(next->from, state);
        state = next->to;
      }
      EXPECT_EQ(state, end) << driveStateName(state);
      EXPECT_LT(steps, 5);
    }
  }
}

TEST(ControlWord, AsksForNoOperationInAFault) {
  for (PowerGoal goal : {PowerGoal::kDisabled, PowerGoal::kEnabled})
    for (DriveState state : {DriveState::kFault, DriveState::kFaultReactionActive})
      EXPECT_EQ(controlWordTowards(goal, state), control_word::kDisableVoltage);
}

}  // namespace
}  // namespace tactus
