#pragma once

#include "tactus/control/fault.h"
#include "tactus/math/types.h"
#include "tactus/supervisor/mode.h"

namespace tactus::campaign {

/// What a judge sees of one cycle, when its frames have been sent. Joints in m or rad, m/s or
/// rad/s.
struct Observation {
  int t_ms = 0;  ///< since the run began
  Mode mode = Mode::kRunning;
  Fault fault = Fault::kNone;
  bool enable = true;  ///< what the daemon is told
  bool is_stop_requested = false;
  bool is_emergency = false;
  bool has_cause = false;              ///< what it is told is a fault: line, bus, lateness, call
  const char* hidden_cause = nullptr;  ///< a trouble that it should have seen by now
  bool is_free = true;                 ///< no trouble is at work
  bool is_calm = true;                 ///< no trouble is at work, but for hands
  bool has_hand = false;               ///< that leans on the arm
  bool is_late_frame = false;          ///< something makes frames late: old setpoints are no wonder
  bool is_brake_open = true;
  bool has_torque = true;      ///< any drive of the plant
  double force_error_N = 0.0;  ///< of the sensor, beside the plant's contact
  JointVector setpoint;        ///< in the frames of this cycle that leave
  JointVector command;         ///< of the controller
  JointVector velocity;        ///< of the plant's drives
  JointVector position;        ///< of its encoders
  double pushed = 0.0;         ///< how far the joint that was moved most by hand is from its place
  int pushed_ms = 0;           ///< for how long it is beyond the tolerance
  unsigned long stale_setpoints = 0;  ///< followed by drives so far
  unsigned long powers_taken = 0;     ///< of drives that moved, so far
  bool may_let_go = false;            ///< by a trouble, not by the daemon
};

}  // namespace tactus::campaign
