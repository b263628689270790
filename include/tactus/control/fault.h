#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace tactus {

/// Why the arm has stopped following its task. Numbers are part of the log's format: only append.
enum class Fault : std::uint8_t {
  kNone = 0,
  kTactileInvalid = 1,
  kTactileStale = 2,
  kCommandNotFinite = 3,
  kTactileSaturated = 4,
  kTactileCableBreak = 5,
  kTareRefused = 6,
  kBusStalled = 7,
  kBusUnacknowledged = 8,
  kBusOff = 9,
  kBusDown = 10,
  kBusFlooded = 11,
  kDriveSilent = 12,
  kDriveFault = 13,
  kDriveStateLost = 14,
  kFollowingError = 15,
  kDriveSetupRefused = 16,
  kNotAtStart = 17,
  kEmergencyStop = 18,
  kGpioLost = 19,
  kOverrun = 20,
  kForbiddenSystemCall = 21,
};

/// How the arm comes to rest, mildest first; a later fault can only make it harsher.
enum class Reaction : std::uint8_t {
  kNone,
  kRetreat,    ///< out of the contact, if there is one; then drives keep the position
  kRamp,       ///< ramp to zero velocity within the acceleration limits, then drives disabled
  kQuickStop,  ///< zero setpoint and quick stop by the drives at once, then disabled
  kBrake,      ///< the same, and the brake line falls at once
};

/// What a fault was judged by. Without a unit the fault has no value.
struct FaultDetail {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< that was seen
  double limit = std::numeric_limits<double>::quiet_NaN();  ///< the largest allowed; NaN: none
  const char* unit = "";                                    ///< of both
  int joint = -1;                                           ///< whose value; -1: no joint's
  int module = -1;                                          ///< likewise of a tactile module
};

/// One row of the fault table, which docs/safety.md and the manual print; `tactus status` shows the
/// remedy.
struct FaultRow {
  Fault fault;
  const char* name;       ///< as in the log and in summary.json
  const char* detection;  ///< what is seen
  const char* within;     ///< time from there to the first command of the reaction
  Reaction reaction;
  const char* remains;  ///< force of a contact in which it came, once the arm rests
  const char* remedy;   ///< what to do before the arm can go on; `what is typed` is marked so
};

const std::array<FaultRow, 22>& faultTable() noexcept;  ///< in the order of the numbers
const FaultRow& faultRow(Fault fault) noexcept;
const char* faultName(Fault fault) noexcept;
const char* reactionName(Reaction reaction) noexcept;

}  // namespace tactus
