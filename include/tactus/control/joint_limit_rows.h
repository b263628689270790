#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

// clang-format off: equations
/// The joints' position limits as rows, for a motion that keeps others, too: what a contact asks
/// for then takes another way, instead of being cut behind the law's back. Of joints that are less
/// than 0.25 (m or rad) from a limit:
///   |q_dot_j| <= min(gamma d_j, sqrt(a_j d_j)) / p_j towards it
/// d_j: what is left to it; gamma = 5 / s; a_j: max_acceleration, of which half brakes that; p_j =
/// 1, or, so that no row begins with a step, 1 - d_j / 0.25. Scaled so that W^-1/2 a of a row is
/// 0.3 long, as a contact point's may be.
// clang-format on
class JointLimitRows {
 public:
  /// fades: the latter.
  JointLimitRows(const JointLimits& limits, bool fades) : limits_(limits), fades_(fades) {}

  /// Adds a row for each joint that is near a limit; where they do not fade only if its own limits
  /// let it come faster than that. share: of the contact that is left, 1 in contact; the rows widen
  /// as it fades.
  void add(const JointVector& q, const TaskKinematics& kinematics,
           const ScaledVector& inv_sqrt_weights, double share, SpeedRows& rows) const noexcept;

  /// Whether a motion with this velocity keeps all of them.
  bool isKept(const JointVector& q, const ScaledVector& velocity, double share) const noexcept;

 private:
  struct Limit {
    double sign;   ///< of a motion away from it
    double speed;  ///< that is allowed towards it
    double presence;
  };
  /// Of joint i; false: it has no row.
  bool find(const JointVector& q, int i, double share, Limit& limit) const noexcept;

  JointLimits limits_;
  bool fades_;
};

}  // namespace tactus
