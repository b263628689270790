#pragma once

#include "tactus/control/gains.h"
#include "tactus/math/filter.h"

namespace tactus {

struct ApproachEstimatorState {
  double stiffness_N_per_m = 0.0;      ///< c; to be set to c_0 at first
  double stiffness_raw_N_per_m = 0.0;  ///< r: the newest quotient; likewise
  double x_m = 0.0;                    ///< way since F_ref, as sensed; > 0 towards the obstacle
  double F_ref_N = 0.0;
  double F_before_N = 0.0;  ///< F_p of the newest sample
  double limited_s = 0.0;   ///< of the time since F_ref, while the limit held the arm back
  KnownLagShare filter, forgetting;
};

/// A force sample in contact, and the way that led to it.
struct ApproachSample {
  double F_p_N = 0.0;          ///< > 0
  double dx_m = 0.0;           ///< as sensed, since the sample before, towards the obstacle
  double interval_s = 0.0;     ///< since the sample before
  double significant_N = 0.0;  ///< F_min: a smaller change of force is noise
  bool is_limiting = false;    ///< the limit holds the arm back
};

// clang-format off: equations
/// Stiffness for the approach-speed limit, a quotient of force and way as sensed, where a mistake
/// costs least: c rises at once, and falls slowly and only far from F_act. At each force sample in
/// contact, with kappa = 1 - exp(-dt / T_est):
///   turned (dx x < 0):  x = 0, F_ref = F_p of the sample before
///   x += dx,  dF = F_p - F_ref
///   dx > 0, dF > F_min:   r = dF / max(x, x_min);  c = r if r > c,
///                         if x > x_min: c += kappa (r - c) else, but only if F_p < F_act / 2,
///                         and re-armed (x = 0, F_ref = F_p)
///   dx > 0, |dF| <= F_min, x > x_min, F_p < F_act / 2:
///                         r = (max(dF, 0) + F_min) / x is an upper bound: c falls towards it
///   dx <= 0, dF < -F_min, x < -x_min:   r = dF / x: c falls towards it;  re-armed
///   force against the way by more than F_min:  re-armed
/// A soft obstacle that comes gives a quotient that is too large, the more the slower the arm is.
/// So for c < 20 kN/m a slow way counts as longer, by what leaves c stable: beyond 2.5 kN/m c
/// rises to no more than dF / min(max(x, v_s t_l), 4 x), with v_s = 10 mm/s and t_l the time since
/// F_ref in which the limit held the arm back.
/// r is clamped to its range. Below F_th x = F_ref = 0, and c returns to c_0 with T_c, but not
/// where the contact is still felt where it was: one that rests at F_th would else be taken for
/// another each time it swings below.
// clang-format on
void estimateInContact(const ForceGains& gains, const ApproachSample& sample,
                       ApproachEstimatorState& state) noexcept;

/// Counts way and force from here on, and keeps c.
void beginWay(double F_p_N, ApproachEstimatorState& state) noexcept;

/// A cycle without force. duration_s: less than the period while the contact may still be the same.
void forgetContact(const ForceGains& gains, double duration_s,
                   ApproachEstimatorState& state) noexcept;

}  // namespace tactus
