#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

// clang-format off: equations
/// The joints' position limits as rows, for a motion that keeps others, too: what a contact asks
/// for then takes another way, instead of being cut behind the law's back.
///   a_j = -+ s e_j,   v_max = s gamma d_j     that is   |q_dot_j| <= gamma d_j  towards the limit
/// d_j: what is left to it; gamma = 5 / s, which a joint can brake to with 2.5 rad/s^2 from 0.1
/// rad; s = 0.3 m/rad, 1 of a sliding joint, makes these rows comparable to those of a contact
/// point.
// clang-format on
class JointLimitRows {
 public:
  JointLimitRows(const JointLimits& limits, const SerialChain& chain);

  /// Adds a row for each joint that could come to a limit faster than that.
  void add(const JointVector& q, const TaskKinematics& kinematics,
           const ScaledVector& inv_sqrt_weights, SpeedRows& rows) const noexcept;

 private:
  JointLimits limits_;
  JointVector lever_m_;  ///< s
};

}  // namespace tactus
