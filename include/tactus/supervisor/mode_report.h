#pragma once

#include <limits>

#include "tactus/canopen/drive.h"
#include "tactus/control/fault.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// A fault with all that is known of it: `joint` or `bus` tells of whom it speaks, -1: of nobody.
struct FaultReport {
  Fault fault = Fault::kNone;
  /// Of the log; NaN: before the arm first moved.
  double time_s = std::numeric_limits<double>::quiet_NaN();
  int joint = -1;
  int bus = -1;
  FaultDetail detail;
  int missed_cycles = 0;    ///< just before it was seen: the cause may be the pause
  DriveReport drive;        ///< of that joint, as it was
  double q_measured = 0.0;  ///< of that joint, m or rad
  double q_expected = 0.0;  ///< where it was commanded to be at last, or where the scene starts
};

/// Where the loop is and why.
struct ModeReport : FaultReport {
  Mode mode = Mode::kBoot;
};

}  // namespace tactus
