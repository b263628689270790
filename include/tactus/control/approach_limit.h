#pragma once

#include <algorithm>

#include "tactus/control/approach_estimator.h"
#include "tactus/control/contact_smoother.h"
#include "tactus/control/obstacle_speed.h"
#include "tactus/control/sensed_position.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

struct ApproachLimitState {
  ContactSmootherState smoother;
  SensedPositionState position;
  ApproachEstimatorState estimator;
  ObstacleSpeedState obstacle;
  double memory_N_per_m = 0.0;  ///< m; 0: no limit
  double way_ahead_m = 0.0;     ///< e
  bool is_limiting = false;     ///< the residual motion was cut in the last cycle
  double rested_N_per_m = 0.0;  ///< c since the arm rests; 0: it does not
  KnownLagShare fade;           ///< of m
};

/// m in contact.
inline double stiffnessInContact(const ForceGains& gains,
                                 const ApproachEstimatorState& estimator) noexcept {
  return std::max(estimator.stiffness_N_per_m, gains.min_approach_stiffness_N_per_m);
}

struct FeltForce {
  double F_p_N = 0.0;  ///< >= 0
  /// 0 to 1, where F_p = 0: how much of c is kept, as it may be the contact that was.
  double nearness = 0.0;
  double fading = 1.0;  ///< share of the cycle in which m fades where F_p = 0
};

// clang-format off: equations
/// The approach-speed limit. While the contact point approaches at v, contact of stiffness c_e
/// obeys dF/dt = c_e v. So let it approach no faster than
///   v_max = (F_act - F^) / (T m) - v_o
/// and for m = c_e the force follows dF/dt = -(F - F_act) / T at most: it settles at F_act without
/// overshoot, whatever pushes the arm on. The derivation, and how small m may be, are in
/// docs/approach_speed_limit.md.
///   F^ = max(0, F_p + m e),   e = -a^T (q_d - q_f): the way that no sample has told of yet
///   m  = max(c, c_floor) in contact, fading with T after it
///   v_o: that of a soft obstacle which comes, see obstacle_speed.h; else 0
/// What the rest of (1) would do, v_res = a^T (J# w_eff - N (b u_n + alpha W^-1 dH/dq)) with
/// v_res < 0 towards the obstacle, is cut by exactly the excess:
///   u_t = min(0, v_res + v_max) / k_t
// clang-format on
class ApproachLimit {
 public:
  /// config.force_control must be there; module: one of its tactile modules.
  ApproachLimit(const ControllerConfig& config, const TactileModuleConfig& module);

  ApproachLimitState initialState() const noexcept;

  /// Takes over a new reading of the sensor; the contact to use is state.smoother.contact.
  void follow(const ForceGains& gains, const ContactPointState& sensor, const Pose& X_BaseModule,
              ApproachLimitState& state) const noexcept;

  /// a: J_p^T F^ of that contact; q_desired: at the start of the cycle.
  void observe(const ForceGains& gains, const ScaledVector& a, const FeltForce& force,
               const JointVector& q_desired, double period_s,
               ApproachLimitState& state) const noexcept;

  /// After observe(), for an arm at rest that follows nothing: what changes the force then, a hand
  /// or an obstacle that moves, says nothing of how stiff a contact is.
  void rest(const ForceGains& gains, double F_p_N, ApproachLimitState& state) const noexcept;

  /// min(0, v_res + v_max), m/s; after observe().
  double excess(const ForceGains& gains, double F_p_N, double v_res_m_per_s,
                ApproachLimitState& state) const noexcept;

  /// For rows, from the first of them on, that limit the approach instead: v_max of (1) times the
  /// cosine of the angle between a row and F^, see docs/approach_speed_limit.md, and T m, of all
  /// alike.
  void limitRows(const ForceGains& gains, double F_p_N, double cosine, double presence,
                 const ApproachLimitState& state, int first, SpeedRows& rows) const noexcept;

 private:
  /// A new force sample in contact.
  void learn(const ForceGains& gains, const ScaledVector& a, int joints, double F_p_N,
             ApproachLimitState& state) const noexcept;

  bool has_estimator_;
  ContactSmoother smoother_;
  SensedPosition position_;
};

}  // namespace tactus
