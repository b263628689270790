#pragma once

#include <string>

#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"
#include "tactus/supervisor/mode_report.h"

/// What people and scripts read of a fault: time, place, value and limit.
namespace tactus {

/// "tactile_invalid, at 3.214 s, 102.5 N, at most 100 N"; the time where the log has it.
std::string faultEvent(const FaultReport& report, const Scene& scene);

/// The same, what that fault is, and how the arm comes to rest.
std::string describeFault(const FaultReport& report, const Scene& scene);

/// Where and why a drive refused its set-up: "object 6502:00: no answer", "register 0x102: is 0x4,
/// expected 0x5".
std::string refusalText(const DriveConfig& drive, const DriveReport& report);

/// "running", or "fault: drive_silent, drive 2 on can1 (joint j5), ...: no feedback ..." and so on.
std::string describeMode(const ModeReport& report, const Scene& scene);

/// What follows "waits for"; empty: for nothing. The fault is the one that has stopped the arm: of
/// kNotAtStart nobody looks at the place before the next start, so it is said here.
std::string wayOnText(const WayOn& way_on, Fault fault);

/// The member "fault" of summary.json: name, time_s, joint, bus, tactile_module, value, limit,
/// unit, description; null for what is not known, and as a whole without a fault.
Json faultJson(const FaultReport& report, const Scene& scene);

}  // namespace tactus
