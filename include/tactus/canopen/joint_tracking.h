#pragma once

#include "tactus/canopen/drive_report.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/math/types.h"

/// How a drive of any kind is kept to where its joint is commanded to be.
namespace tactus {

/// velocity, m/s or rad/s, and what leads from where the drive was measured to `position`, m or
/// rad: tracking_gain_per_s times the difference, of which no more than max_following_error counts,
/// also where the measured position is old. Within max_velocity.
double trackingVelocity(const DriveConfig& config, double velocity, double position,
                        double measured) noexcept;

/// Where a drive is commanded to be, m or rad. Feedback that comes after missed cycles may have
/// been measured in any of them.
struct CommandedPlace {
  double now;
  double before_pause;  ///< the same where no cycle was missed
};

/// Where all drives are commanded to be, cycle by cycle, and for some cycles after missed ones
/// where they were before the last of these: feedback may be late.
class CommandedPlaces {
 public:
  explicit CommandedPlaces(const JointVector& q) : q_now_(q), q_before_pause_(q) {}

  void coast() noexcept;  ///< cycles were missed since the last command()
  /// Where they are as a cycle begins, and by its command.
  void expect(const JointVector& q) noexcept { q_now_ = q; }
  void command(const JointVector& q) noexcept;

  CommandedPlace at(int joint) const noexcept;
  const JointVector& now() const noexcept { return q_now_; }

 private:
  JointVector q_now_, q_before_pause_;
  int late_cycles_ = 0;  ///< that are left
};

/// How far `position` is from the way between the two; 0: it is on it.
double distanceFrom(const CommandedPlace& place, double position) noexcept;

/// Latches kFollowingError, or kCommandNotFinite. is_new: the report's position came in this cycle.
void judgePosition(const DriveConfig& config, const CommandedPlace& place, bool is_new,
                   DriveReport& report) noexcept;

}  // namespace tactus
