#include "tactus/control/fault.h"

namespace tactus {
namespace {

struct FaultRows {
  using enum Fault;
  static constexpr auto kRetreat = Reaction::kRetreat;
  static constexpr auto kRamp = Reaction::kRamp;
  static constexpr auto kQuickStop = Reaction::kQuickStop;
  static constexpr auto kBrake = Reaction::kBrake;
  static constexpr auto kRelieved =
      "at most F_act + F_th within 1 s; after a reading that is no number or off the cover as "
      "after "
      "tactile_stale";
  static constexpr auto kLastFelt = "the last one felt, less what the way out takes";
  static constexpr auto kAsStopped = "that where the arm stops";
  static constexpr auto kUnmoved = "that from before";
  static constexpr std::array<FaultRow, 22> kTable = {{
      {kNone, "none", "", "", Reaction::kNone, ""},
      {kTactileInvalid, "tactile_invalid",
       "a reading not finite, beyond max_force_N, or of a push far off the cover",
       "a sample and 2 cycles", kRetreat, kRelieved},
      {kTactileStale, "tactile_stale", "no new sample for max_sample_age_s",
       "max_sample_age_s and 2 cycles", kRetreat, kLastFelt},
      {kCommandNotFinite, "command_not_finite", "the law produced NaN or infinity",
       "the same cycle", kRamp, kAsStopped},
      {kTactileSaturated, "tactile_saturated", "a channel at its rail, or the module says so",
       "a sample and 2 cycles", kRetreat, kLastFelt},
      {kTactileCableBreak, "tactile_cable_break", "the module reports a broken cable",
       "a sample and 2 cycles", kRetreat, kLastFelt},
      {kTareRefused, "tare_refused", "force at rest too large or not steady: a contact",
       "before motion", kRamp, kUnmoved},
      {kBusStalled, "bus_stalled",
       "frames of three cycles not confirmed, no error frame; at first, an interface just taken "
       "away",
       "4 cycles", kQuickStop, kAsStopped},
      {kBusUnacknowledged, "bus_unacknowledged",
       "error-passive without acknowledgement; at the start, no frame confirmed or heard",
       "1 cycle", kQuickStop, kAsStopped},
      {kBusOff, "bus_off", "the controller left the bus", "1 cycle", kQuickStop, kAsStopped},
      {kBusDown, "bus_down", "the interface is down or gone", "1 cycle", kQuickStop, kAsStopped},
      {kBusFlooded, "bus_flooded", "more frames in a cycle than the bus can carry", "1 cycle",
       kQuickStop, kAsStopped},
      {kDriveSilent, "drive_silent", "no feedback for five cycles, or its heartbeat missing",
       "6 cycles", kQuickStop, kAsStopped},
      {kDriveFault, "drive_fault", "status word or emergency message says fault", "1 cycle",
       kQuickStop, kAsStopped},
      {kDriveStateLost, "drive_state_lost",
       "a drive left operation unasked, started anew, or was not switched on or off in time",
       "1 cycle", kQuickStop, kAsStopped},
      {kFollowingError, "following_error", "measured position too far from the commanded one",
       "1 cycle", kQuickStop, kAsStopped},
      {kDriveSetupRefused, "drive_setup_refused", "a drive refuses its set-up, or does not answer",
       "before motion", kQuickStop, kUnmoved},
      {kNotAtStart, "not_at_start", "the arm is not where the scene starts, or was left",
       "before motion", kRamp, kUnmoved},
      {kEmergencyStop, "emergency_stop", "the e-stop line, polled each cycle", "1 cycle", kBrake,
       kAsStopped},
      {kGpioLost, "gpio_lost", "a GPIO line cannot be read or written", "1 cycle", kQuickStop,
       kAsStopped},
      {kOverrun, "overrun", "more than max_late_cycles late cycles in a row", "1 cycle", kRamp,
       kAsStopped},
      {kForbiddenSystemCall, "forbidden_system_call", "the loop left its list of system calls",
       "1 cycle", kRamp, kAsStopped},
  }};
};

}  // namespace

const std::array<FaultRow, 22>& faultTable() noexcept { return FaultRows::kTable; }

const FaultRow& faultRow(Fault fault) noexcept {
  const auto number = static_cast<std::size_t>(fault);
  return faultTable()[number < faultTable().size() ? number : 0];
}

const char* faultName(Fault fault) noexcept {
  const bool is_known = static_cast<std::size_t>(fault) < faultTable().size();
  return is_known ? faultRow(fault).name : "unknown";
}

const char* reactionName(Reaction reaction) noexcept {
  static constexpr std::array<const char*, 5> kNames = {"none", "retreat", "ramp", "quick stop",
                                                        "quick stop and brake"};
  return kNames[static_cast<std::size_t>(reaction)];
}

}  // namespace tactus
