#pragma once

#include <string>
#include <vector>

#include "campaign/observation.h"
#include "tactus/control/controller_config.h"

namespace tactus::campaign {

/// What a judge saw, the first time.
struct Violation {
  const char* judge;
  std::string what;  ///< the class: the same words for the same defect
  std::string detail;
  int t_ms;
};

/// What the scene promises.
struct Promise {
  JointLimits limits;
  JointVector counts_per_unit;
  double period_s = 0.001;
  double start_tolerance = 0.02;
  double max_following_error = 0.05;
  int brake_ms = 100;
  JointVector quick_stop;  ///< of the drives, m/s^2 or rad/s^2
};

/// Looks for one kind of harm. `now` is compared with `before`, the cycle before.
struct Look {
  const Promise& promise;
  const Observation& before;
  const Observation& now;
  std::vector<Violation>& found;

  void complain(const char* judge, const std::string& what, const std::string& detail = "") const;
  bool entered(Mode mode) const { return now.mode == mode && before.mode != mode; }
};

/// Setpoints and commands within the joints' limits.
struct LimitsJudge {
  void look(const Look& look);
};

/// Setpoints are zero where nothing may move, and after the ramp of a hold or an end; a retreat has
/// one.
struct StopJudge {
  int retreat_ms = 0;
  int cycles = 0, allowed = 0;
  void look(const Look& look);
};

/// Nothing moves without the enable line, nor again before it was off and on without a cause.
struct EnableJudge {
  int off_ms = 0, last_off_ms = -1, last_stop_ms = -1, last_cause_ms = -1;
  void look(const Look& look);
};

struct BrakeJudge {
  int fault_ms = 0, limp_ms = 0;
  void look(const Look& look);
};

/// The plant's drives stand where the daemon says so.
struct RestJudge {
  int rest_ms = 0;  ///< since anything was commanded
  int off_ms = 0;
  int stopped_ms = 0;       ///< since the task was left
  int torque_ms = 0;        ///< that drives have in ready
  bool has_let_go = false;  ///< a drive, while it moved
  JointVector position;     ///< when the arm should have come to rest
  JointVector peak;         ///< velocity since the task was left: so long takes a quick stop
  void look(const Look& look);
};

/// An arm that was pushed away does not start.
struct PlaceJudge {
  void look(const Look& look);
};

/// While a cause is there nothing runs.
struct CauseJudge {
  void look(const Look& look);
};

/// Every stop has a name, which stays until it is cleared; modes change as their table says.
struct NameJudge {
  void look(const Look& look);
};

/// A stop request ends.
struct EndJudge {
  int waiting_ms = 0;
  void look(const Look& look);
};

/// No drive follows an old setpoint.
struct StaleJudge {
  void look(const Look& look);
};

/// The sensor's zero is where it was: one that was tared under a force errs for as long as one
/// looks, its filter only for moments.
struct ForceJudge {
  int ms = 0;
  double error_N = 0.0;  ///< the smallest
  void look(const Look& look);
};

/// No drive is told to let go while it moves, but where a brake holds it.
struct PowerJudge {
  int held_ms = 0;  ///< since the brake was told to close
  void look(const Look& look);
};

struct Judges {
  LimitsJudge limits;
  StopJudge stop;
  EnableJudge enable;
  BrakeJudge brake;
  RestJudge rest;
  PlaceJudge place;
  CauseJudge cause;
  NameJudge name;
  EndJudge end;
  StaleJudge stale;
  ForceJudge force;
  PowerJudge power;

  void look(const Look& look);
};

}  // namespace tactus::campaign
