#pragma once

#include <deque>
#include <vector>

#include "campaign/judges.h"
#include "campaign/plan.h"
#include "campaign/stage.h"

namespace tactus::campaign {

/// Notes where the arm goes on, and how fast it is then: the run compares with one that was not
/// disturbed.
struct GoingOn {
  int stop_ms = 0;    ///< when it last stopped running
  int return_ms = 0;  ///< and ran again
  int end_ms = 0;     ///< of what was looked at: 3 s, the next stop or the hand's end
  /// Of commands and drives, m/s or rad/s, less what a hand adds that leans on.
  double peak = 0.0;
  double before = 0.0;         ///< the same, in the last 0.2 s before the stop
  bool has_hand = false;       ///< that still leans on the arm, which gives way to it then
  bool is_hold = false;        ///< the stop was one by the enable line alone
  bool has_retreated = false;  ///< in the stop
};

struct GoingOnJudge {
  static constexpr int kWindow_ms = 3000;
  /// A hand that leaned on the running arm for so long lets go of one that stands by what has been
  /// since it went on.
  static constexpr int kLeaned_ms = 1000;
  std::vector<GoingOn> all;
  std::vector<bool> is_calm;  ///< of each
  int stop_ms = -1;
  bool is_hold = false;  ///< so far, since then
  bool has_retreated = false;
  std::deque<double> newest;  ///< of the last 0.2 s of running, m/s or rad/s
  void look(const Look& look);
  void end(int now_ms);  ///< of the run
  double peak() const;   ///< the largest while nothing was at work but hands
};

/// Complains of what was faster than in the same run without a trouble, in which nobody leans on
/// the arm in the last stop; or, where a hand is there beyond the stop, that leans on it then, too.
/// Two runs that went apart before the stop, as where an arm meets the band a little elsewhere,
/// cannot be compared: there it may be as fast as just before the stop, if nothing but hands was at
/// work then, or as in the same run without this stop, if it was a hold, with or without a hand in
/// it, for who takes it away at the end lets go of an arm that gives way as long as it feels that.
/// Where a hand leans on, the runs go apart by what it makes the arm do, as the arm does not stand
/// in the same posture: there 0.5 rad/s or a quarter are no wonder. And who leans on an arm
/// accelerates it, by F_p / (T^2 c), where the null space suffices, but hardly, where the approach
/// limit holds the integral: which of both happens hangs on little. So 0.5 rad/s^2 more since it
/// goes on are no wonder either. What an arm remembers would show at once. After a retreat it has a
/// way back to its path, which nobody has who held on it: 0.5 rad/s more. Adds the cycles that all
/// this takes.
void compareGoingOn(const Stage& stage, const Plan& plan, const GoingOnJudge& judge,
                    std::vector<Violation>& found, long long& cycles);

}  // namespace tactus::campaign
