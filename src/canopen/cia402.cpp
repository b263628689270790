#include "tactus/canopen/cia402.h"

namespace tactus {

const char* driveStateName(DriveState state) noexcept {
  static constexpr std::array<const char*, 8> kNames = {
      "not ready to switch on", "switch on disabled", "ready to switch on",    "switched on",
      "operation enabled",      "quick stop active",  "fault reaction active", "fault"};
  return kNames[static_cast<std::size_t>(state)];
}

std::optional<DriveState> decodeStatusWord(std::uint16_t status_word) noexcept {
  switch (status_word & 0x4F) {  // states for which the quick-stop bit (5) does not matter
    case 0x00:
      return DriveState::kNotReady;
    case 0x40:
      return DriveState::kSwitchOnDisabled;
    case 0x0F:
      return DriveState::kFaultReactionActive;
    case 0x08:
      return DriveState::kFault;
  }
  switch (status_word & 0x6F) {
    case 0x21:
      return DriveState::kReadyToSwitchOn;
    case 0x23:
      return DriveState::kSwitchedOn;
    case 0x27:
      return DriveState::kOperationEnabled;
    case 0x07:
      return DriveState::kQuickStopActive;
  }
  return std::nullopt;
}

const std::array<PowerTransition, 17>& powerTransitions() noexcept {
  using enum DriveState;
  using namespace control_word;
  // Disabling goes by 5, which slows down, not by 8 or 9, which may let the axis coast. 12 waits
  // for the end of the quick stop (option code 2): disabling the voltage would cut it short, which
  // is for who knows that the axis rests. 15 is no step to any goal: clearing a fault is a
  // decision.
  static constexpr std::array<PowerTransition, 17> kTable = {{
      {0, {}, kNotReady, true, kDisableVoltage, false, false},
      {1, kNotReady, kSwitchOnDisabled, true, kDisableVoltage, true, true},
      {2, kSwitchOnDisabled, kReadyToSwitchOn, false, kShutdown, false, true},
      {3, kReadyToSwitchOn, kSwitchedOn, false, kSwitchOn, false, true},
      {4, kSwitchedOn, kOperationEnabled, false, kEnableOperation, false, true},
      {5, kOperationEnabled, kSwitchedOn, false, kDisableOperation, true, false},
      {6, kSwitchedOn, kReadyToSwitchOn, false, kShutdown, false, false},
      {7, kReadyToSwitchOn, kSwitchOnDisabled, false, kQuickStop, true, false},
      {8, kOperationEnabled, kReadyToSwitchOn, false, kShutdown, false, false},
      {9, kOperationEnabled, kSwitchOnDisabled, false, kDisableVoltage, false, false},
      {10, kSwitchedOn, kSwitchOnDisabled, false, kQuickStop, true, false},
      {11, kOperationEnabled, kQuickStopActive, false, kQuickStop, false, false},
      {12, kQuickStopActive, kSwitchOnDisabled, true, kQuickStop, true, true},
      {13, {}, kFaultReactionActive, true, kDisableVoltage, false, false},
      {14, kFaultReactionActive, kFault, true, kDisableVoltage, false, false},
      {15, kFault, kSwitchOnDisabled, false, kFaultReset, false, false},
      {16, kQuickStopActive, kOperationEnabled, false, kEnableOperation, false, false},
  }};
  return kTable;
}

const PowerTransition* nextTransition(DriveState state, PowerGoal goal) noexcept {
  if (goal == PowerGoal::kQuickStop) return nullptr;
  for (const PowerTransition& transition : powerTransitions()) {
    const bool serves =
        goal == PowerGoal::kEnabled ? transition.to_enabled : transition.to_disabled;
    if (serves && transition.from == state) return &transition;
  }
  return nullptr;
}

std::uint16_t controlWordTowards(PowerGoal goal, DriveState state) noexcept {
  // The same in every state, so that it stops the drive also where its state is not known yet.
  if (goal == PowerGoal::kQuickStop) return control_word::kQuickStop;
  const PowerTransition* const next = nextTransition(state, goal);
  if (next != nullptr) return next->control_word;
  const bool is_running = goal == PowerGoal::kEnabled && state == DriveState::kOperationEnabled;
  return is_running ? control_word::kEnableOperation : control_word::kDisableVoltage;
}

}  // namespace tactus
