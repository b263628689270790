#pragma once

#include "tactus/canopen/drive_report.h"
#include "tactus/canopen/rest_watch.h"

namespace tactus {

/// Watches that a drive of any kind comes to rest when it is told to, whatever it says.
class StopWatch {
 public:
  StopWatch(int deadline_cycles, double period_s)
      : deadline_cycles_(deadline_cycles), rest_watch_(period_s) {}

  /// For cycles that were missed just before this one: deadlines go on in them, but what the drive
  /// did meanwhile is heard in the next cycles, which therefore remain.
  void coast(int missed_cycles) noexcept;

  /// Once a cycle, before what is sent. ignores: it follows setpoints, though it is to have no
  /// power; beyond the deadline that is kDriveStateLost. is_unheard: its position is an old one.
  /// periods_heard: see RestWatch. In a quick stop report.is_moving_on and report.is_cut_off say
  /// whether it obeys; in all else they are false.
  void update(DriveGoal goal, bool ignores, bool is_unheard, int periods_heard,
              DriveReport& report) noexcept;

 private:
  int deadline_cycles_;
  RestWatch rest_watch_;
  int ignored_cycles_ = 0;     ///< in a row, counted up to the deadline
  int quick_stop_cycles_ = 0;  ///< likewise
};

}  // namespace tactus
