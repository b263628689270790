#pragma once

#include "tactus/control/gains.h"
#include "tactus/record/contact_list.h"
#include "tactus/record/touch_fit.h"

namespace tactus {

/// What there is to say of one contact. Forces are the sensor's, F_sen. How it rests is of its last
/// second, or of its second half, without the 0.1 s in which it ended; NaN where no record of that
/// is there.
struct ContactFigures : ContactSummary {
  double position_m = 0.0;    ///< along the link, at the peak
  double time_above_s = 0.0;  ///< with F_sen > F_act + F_th
  double rest_force_N = 0.0;  ///< mean
  double swing_N = 0.0;       ///< from the smallest to the largest force at rest
  double swing_hz = 0.0;      ///< of passages of the mean, three at least; 0 below 0.1 N
  /// c, as the law takes it, at the end, or where last no other module felt more; NaN: one always
  /// did.
  double stiffness_N_per_m = 0.0;
  TouchFit touch;  ///< c_e, as force and way say
  double tcp_error_max_m = 0.0;
  /// Of the time that the law answers, that in which the null space does alone.
  double null_share = 0.0;
  /// Of the way that the law gave the contact point, what the task space did: all of |k_t u_t| over
  /// all of |k_n u_n| + |k_j u_j| + |k_t u_t|; NaN where there was an answer without k.
  double task_share = 0.0;
  Gains gains;  ///< at its start
};

}  // namespace tactus
