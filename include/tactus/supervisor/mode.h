#pragma once

#include <cstdint>

#include "tactus/control/fault.h"

namespace tactus {

/// Where the daemon is between power-up and rest. Numbers are part of the log's format: only
/// append.
enum class Mode : std::uint8_t {
  kBoot = 0,        ///< drives are being configured, the tactile module is tared
  kReady = 1,       ///< all configured, power off; waits for the enable line
  kEnabling = 2,    ///< drives switch on, brakes open
  kRunning = 3,     ///< the controller follows its task
  kHolding = 4,     ///< ramps to rest, drives keep the position
  kStopping = 5,    ///< ramps to rest, then drives switch off
  kFault = 6,       ///< quick stop or off; drives are off as soon as the arm rests
  kOff = 7,         ///< the end: drives off, or out of reach
  kRetreating = 8,  ///< leaves the contact in which a fault has stopped it
};

inline constexpr int kModeCount = 9;
const char* modeName(Mode mode) noexcept;
/// The controller's command moves the arm, or keeps it where it is.
bool isCommanding(Mode mode) noexcept;

/// Whether the mode table (mode_table.h) has such a change.
bool isLegal(Mode from, Mode to) noexcept;

/// What a cycle knows when it decides on the mode.
struct ModeInput {
  Fault fault = Fault::kNone;    ///< seen in this cycle
  bool stop_requested = false;   ///< by the user: end at rest
  bool has_enable_line = false;  ///< without one, movement is enabled from the start
  bool enable = true;            ///< state of that line
  bool must_go_off = false;      ///< it is on, but not taken for on before it was off
  bool are_configured = false;   ///< drives configured, modules tared, samples coming
  bool are_enabled = false;      ///< every drive follows setpoints
  bool are_disabled = true;      ///< no drive that can be reached has power
  bool is_at_rest = true;        ///< the commanded velocity is zero
  bool is_retreat_over = false;  ///< the contact is left, or as far as it could be
  int missed_cycles = 0;         ///< just before this one; deadlines of a stop go on in them
};

/// Far beyond every time limit, and below where a count would overflow: an arm may run for months.
inline constexpr int kMaxCyclesInMode = 1 << 30;

struct ModeState {
  Mode mode = Mode::kBoot;
  Fault fault = Fault::kNone;           ///< the first one since the last clearing
  Reaction reaction = Reaction::kNone;  ///< the harshest since then
  bool may_clear = false;               ///< the enable line was off since the fault or hold
  int cycles_in_mode = 0;               ///< counted up to kMaxCyclesInMode
  int enabled_cycles = 0;               ///< in a row, while enabling
};

/// Time limits, in cycles.
struct ModeConfig {
  int boot_cycles = 5000;        ///< to configure all drives: kDriveSetupRefused
  int enabling_cycles = 2000;    ///< to switch on: kDriveStateLost
  int retreating_cycles = 1500;  ///< to leave a contact
  int stopping_cycles = 2000;    ///< to end: kDriveStateLost, and after as many again, off
  int brake_cycles = 0;          ///< between switched on and moving, for the brakes to open
};

/// The supervisor: one step of the mode table (mode_table.h). A fault is answered by its row of the
/// fault table; a second fault can only make the reaction harsher. A fault is cleared, and movement
/// after a hold resumed, by switching the enable line off and on again while the cause is gone; a
/// robot without that line ends.
void updateMode(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept;

/// What an arm that does not run waits for, as far as people can do something about it.
enum class WaitsFor : std::uint8_t {
  kNothing = 0,  ///< it runs, is about to, or ends
  kFaultGone,    ///< that there is now; it may be another than the one that has stopped the arm
  kDrivesOff,    ///< or the deadline for that; an enable line that is switched before is not heard
  kEnableOff,    ///< and then on
  kEnableOn,
};
/// Aligned so that one instruction hands it on to other threads.
struct alignas(2) WayOn {
  WaitsFor waits_for = WaitsFor::kNothing;
  Fault fault = Fault::kNone;  ///< kFaultGone: which
};

/// After updateMode() with the same input.
WayOn wayOn(const ModeConfig& config, const ModeInput& input, const ModeState& state) noexcept;

}  // namespace tactus
