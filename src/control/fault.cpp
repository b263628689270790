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
      {kNone, "none", "", "", Reaction::kNone, "", ""},
      {kTactileInvalid, "tactile_invalid",
       "a reading not finite, beyond max_force_N, or of a push far off the cover",
       "a sample and 2 cycles", kRetreat, kRelieved,
       "take away what pushes; where nothing does, `tactus calibrate show` has the channels: a "
       "cell, its wire or the calibration is wrong"},
      {kTactileStale, "tactile_stale", "no new sample for max_sample_age_s",
       "max_sample_age_s and 2 cycles", kRetreat, kLastFelt,
       "see to the module's power, wire and bus until samples come again; after missed cycles see "
       "what `tactus doctor` finds"},
      {kCommandNotFinite, "command_not_finite", "the law produced NaN or infinity",
       "the same cycle", kRamp, kAsStopped,
       "take back the gains that were changed last; if it comes again, keep `run.ulg`, which "
       "`tactus replay` computes anew, and report it"},
      {kTactileSaturated, "tactile_saturated", "a channel at its rail, or the module says so",
       "a sample and 2 cycles", kRetreat, kLastFelt,
       "take away what pushes; where nothing does, `tactus calibrate show` has the channels: "
       "one at its end has a broken cell or wire"},
      {kTactileCableBreak, "tactile_cable_break", "the module reports a broken cable",
       "a sample and 2 cycles", kRetreat, kLastFelt,
       "mend the module's cable or plug, until its status byte says no more of it"},
      {kTareRefused, "tare_refused", "force at rest too large or not steady: a contact",
       "before motion", kRamp, kUnmoved,
       "take away what leans on the cover or shakes it; where that is the cover's own weight, set "
       "`tare.max_offset_N` above it and start the daemon anew"},
      {kBusStalled, "bus_stalled",
       "frames of three cycles not confirmed, no error frame; at first, an interface just taken "
       "away",
       "4 cycles", kQuickStop, kAsStopped,
       "see to the adapter, its driver (`dmesg`) and what else fills the bus; `ip link set canX "
       "down`, then `up`, starts the adapter anew"},
      {kBusUnacknowledged, "bus_unacknowledged",
       "error-passive without acknowledgement; at the start, no frame confirmed or heard",
       "1 cycle", kQuickStop, kAsStopped,
       "see to the nodes' power, to cable and bit rate, until a node acknowledges; with moteus "
       "drives before that `ip link set canX down`, then `up`, so that no setpoint waits"},
      {kBusOff, "bus_off", "the controller left the bus", "1 cycle", kQuickStop, kAsStopped,
       "mend cable, termination or bit rate, then `ip link set canX down`, and `up`: with "
       "`restart-ms 0` the bus stays off until then"},
      {kBusDown, "bus_down", "the interface is down or gone", "1 cycle", kQuickStop, kAsStopped,
       "`ip link set canX up`; an interface that was removed needs a new start of the daemon, too"},
      {kBusFlooded, "bus_flooded", "more frames in a cycle than the bus can carry", "1 cycle",
       kQuickStop, kAsStopped,
       "stop the node or program that sends without end; `candump canX` shows its identifiers"},
      {kDriveSilent, "drive_silent", "no feedback for five cycles, or its heartbeat missing",
       "6 cycles", kQuickStop, kAsStopped,
       "see to the drive's power and wire; the text says whether feedback or heartbeat is missing"},
      {kDriveFault, "drive_fault", "status word or emergency message says fault", "1 cycle",
       kQuickStop, kAsStopped,
       "mend what the drive's manual says to the code in the text; going on resets the fault "
       "itself"},
      {kDriveStateLost, "drive_state_lost",
       "a drive left operation unasked, started anew, or was not switched on or off in time",
       "1 cycle", kQuickStop, kAsStopped,
       "see why the drive went off, or not on or off: supply of its power stage, safe torque off, "
       "its enable input, somebody else on the bus; the text has its state"},
      {kFollowingError, "following_error", "measured position too far from the commanded one",
       "1 cycle", kQuickStop, kAsStopped,
       "free the joint, or mend its drive or encoder, and bring it back by hand within "
       "`drives.start_tolerance` of where it was commanded; or start the daemon anew with a scene "
       "that brings it back by `start_measured`"},
      {kDriveSetupRefused, "drive_setup_refused", "a drive refuses its set-up, or does not answer",
       "before motion", kQuickStop, kUnmoved,
       "set in the drive, or correct in robot.yaml, the object or register that the text names; "
       "without an answer see to the drive's power, wire and node id"},
      {kNotAtStart, "not_at_start", "the arm is not where the scene starts, or was left",
       "before motion", kRamp, kUnmoved,
       "bring the arm by hand to where the text expects it; or start the daemon anew, with a scene "
       "that begins where `tactus where` finds the arm, or that brings it back by "
       "`start_measured`"},
      {kEmergencyStop, "emergency_stop", "the e-stop line, polled each cycle", "1 cycle", kBrake,
       kAsStopped,
       "see why it was pressed, and release it; where nobody pressed it, see to the line's wire "
       "and to `active_low`"},
      {kGpioLost, "gpio_lost", "a GPIO line cannot be read or written", "1 cycle", kQuickStop,
       kAsStopped,
       "see to the chip and its wires; one that was removed needs a new start of the daemon, too"},
      {kOverrun, "overrun", "more than max_late_cycles late cycles in a row", "1 cycle", kRamp,
       kAsStopped,
       "stop the daemon and mend what `tactus doctor` finds; the fault itself is gone with the "
       "first cycle in time"},
      {kForbiddenSystemCall, "forbidden_system_call", "the loop left its list of system calls",
       "1 cycle", kRamp, kAsStopped,
       "start the daemon anew; the journal names the call as it ends: report it, it is a defect"},
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
