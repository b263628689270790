#pragma once

#include <cstdint>
#include <span>

#include "tactus/supervisor/mode.h"

namespace tactus {

/// What a row of the mode table may ask of a cycle, a bit each.
enum ModeCondition : std::uint32_t {
  kIfStopRequested = 1U << 0,   ///< by the user
  kIfEnableOn = 1U << 1,        ///< the line's state; without a line always
  kIfEnableOff = 1U << 2,       ///< likewise
  kIfEnableLine = 1U << 3,      ///< there is such a line
  kIfNoEnableLine = 1U << 4,    ///< there is none
  kIfConfigured = 1U << 5,      ///< drives configured, modules tared, samples coming
  kIfFollowing = 1U << 6,       ///< every drive follows setpoints
  kIfNotFollowing = 1U << 7,    ///< one does not
  kIfBrakesHadTime = 1U << 8,   ///< to open, while every drive followed
  kIfAtRest = 1U << 9,          ///< the commanded velocity is zero
  kIfDrivesOff = 1U << 10,      ///< no drive that can be reached has power
  kIfOffOrTimeOver = 1U << 11,  ///< likewise, or time over
  kIfTimeOver = 1U << 12,       ///< the mode's time limit
  kIfRetreatOver = 1U << 13,    ///< the contact is left, or as far as it could be
  kIfFault = 1U << 14,          ///< one is latched
  kIfRetreats = 1U << 15,       ///< what is latched asks for a retreat
  kIfRamps = 1U << 16,          ///< for a ramp
  kIfStopsAtOnce = 1U << 17,    ///< for a quick stop
  kIfCauseGone = 1U << 18,      ///< no fault is seen in this cycle
  kIfWasOff = 1U << 19,         ///< the enable line was off since the fault or hold
};

/// What a row does beside the change of mode.
enum class ModeEffect : std::uint8_t {
  kNone,
  kCountFollowing,  ///< one cycle more in which every drive follows
  kCountAnew,       ///< such cycles
  kRememberOff,     ///< the enable line has been off
  kClear,           ///< the fault is acknowledged
};

struct ModeRow {
  Mode from, to;
  std::uint32_t conditions;         ///< all of these ModeCondition
  Fault time_limit = Fault::kNone;  ///< latched by the row
  ModeEffect effect = ModeEffect::kNone;
};

/// The mode table: of a mode's rows the first that holds is taken, and none stays in the mode. What
/// is not in it does not happen.
std::span<const ModeRow> modeRows() noexcept;

/// What an open brake may ask of a cycle.
enum BrakeCondition : std::uint32_t {
  kIfBrakeWasOpen = 1U << 0,    ///< a fault or a stop opens none
  kIfAllFollow = 1U << 1,       ///< every drive follows setpoints
  kIfNotResting = 1U << 2,      ///< the ramp goes on
  kIfAnyHolds = 1U << 3,        ///< a drive may yet hold its joint, or slow it down
  kIfNoneMovesOn = 1U << 4,     ///< no drive goes on as fast as before
  kIfBeforeDeadline = 1U << 5,  ///< BrakeConfig::deadline_cycles of the mode
};

struct BrakeRow {
  Mode mode;
  std::uint32_t conditions;  ///< all of these BrakeCondition
};

/// In which modes brakes are open, and if what: one row a mode. Closed in all others, and after a
/// fault that closes them at once in all.
std::span<const BrakeRow> brakeRows() noexcept;

}  // namespace tactus
