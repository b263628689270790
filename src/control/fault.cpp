#include "tactus/control/fault.h"

namespace tactus {

const std::array<FaultRow, 22>& faultTable() noexcept {
  using enum Fault;
  constexpr auto kHold = Reaction::kHold;
  constexpr auto kRamp = Reaction::kRamp;
  constexpr auto kQuickStop = Reaction::kQuickStop;
  constexpr auto kBrake = Reaction::kBrake;
  static constexpr std::array<FaultRow, 22> kTable = {{
      {kNone, "none", "", "", Reaction::kNone},
      {kTactileInvalid, "tactile_invalid", "a reading not finite or beyond max_force_N",
       "a sample and 2 cycles", kHold},
      {kTactileStale, "tactile_stale", "no new sample for max_sample_age_s",
       "max_sample_age_s and 2 cycles", kHold},
      {kCommandNotFinite, "command_not_finite", "the law produced NaN or infinity",
       "the same cycle", kRamp},
      {kTactileSaturated, "tactile_saturated", "a channel at its rail, or the module says so",
       "a sample and 2 cycles", kHold},
      {kTactileCableBreak, "tactile_cable_break", "the module reports a broken cable",
       "a sample and 2 cycles", kHold},
      {kTareRefused, "tare_refused", "force at rest too large or not steady: a contact",
       "before motion", kRamp},
      {kBusStalled, "bus_stalled",
       "frames of three cycles not confirmed, no error frame; at first, an interface just taken "
       "away",
       "4 cycles", kQuickStop},
      {kBusUnacknowledged, "bus_unacknowledged", "error-passive without acknowledgement", "1 cycle",
       kQuickStop},
      {kBusOff, "bus_off", "the controller left the bus", "1 cycle", kQuickStop},
      {kBusDown, "bus_down", "the interface is down or gone", "1 cycle", kQuickStop},
      {kBusFlooded, "bus_flooded", "more frames in a cycle than the bus can carry", "1 cycle",
       kQuickStop},
      {kDriveSilent, "drive_silent", "no feedback for five cycles, or its heartbeat missing",
       "6 cycles", kQuickStop},
      {kDriveFault, "drive_fault", "status word or emergency message says fault", "1 cycle",
       kQuickStop},
      {kDriveStateLost, "drive_state_lost", "a drive left operation unasked, or started anew",
       "1 cycle", kQuickStop},
      {kFollowingError, "following_error", "measured position too far from the commanded one",
       "1 cycle", kQuickStop},
      {kDriveSetupRefused, "drive_setup_refused", "a drive refuses its set-up, or does not answer",
       "before motion", kQuickStop},
      {kNotAtStart, "not_at_start", "the arm is not where the scene starts, or was left",
       "before motion", kRamp},
      {kEmergencyStop, "emergency_stop", "the e-stop line, polled each cycle", "1 cycle", kBrake},
      {kGpioLost, "gpio_lost", "a GPIO line cannot be read or written", "1 cycle", kQuickStop},
      {kOverrun, "overrun", "more than max_late_cycles late cycles in a row", "1 cycle", kRamp},
      {kForbiddenSystemCall, "forbidden_system_call", "the loop left its list of system calls",
       "1 cycle", kRamp},
  }};
  return kTable;
}

const FaultRow& faultRow(Fault fault) noexcept {
  const auto number = static_cast<std::size_t>(fault);
  return faultTable()[number < faultTable().size() ? number : 0];
}

const char* faultName(Fault fault) noexcept {
  const bool is_known = static_cast<std::size_t>(fault) < faultTable().size();
  return is_known ? faultRow(fault).name : "unknown";
}

const char* reactionName(Reaction reaction) noexcept {
  static constexpr std::array<const char*, 5> kNames = {"none", "hold", "ramp", "quick stop",
                                                        "quick stop and brake"};
  return kNames[static_cast<std::size_t>(reaction)];
}

}  // namespace tactus
