#pragma once

#include "tactus/control/control_law.h"
#include "tactus/control/motion.h"

namespace tactus {

/// How the motion without contact changes, and what it has come to; Controller computes it.
struct FreeAcceleration {
  /// w_dd_d + beta (w_dot_d - w_dot) - J_dot q_dot: what J q_dd is while the tool has the velocity
  /// of (2); m/s^2, rad/s^2.
  PaddedTaskVector w_dd;
  ScaledVector v_before;      ///< W^1/2 times the previous command
  PaddedTaskVector y_before;  ///< Q^T v_before
  ScaledVector cost_change;   ///< of -alpha W^-1/2 dH/dq since the last cycle
};

// clang-format off: equations
/// The second level of control, resolved acceleration (Luh, Walker and Paul 1980, the paper's
/// [31]); docs/acceleration_level.md has the derivation:
///   q_dd = J# (w_dd_eff - J_dot q_dot) + N q_dd_n + contact
///   w_dd_eff = w_dd_d + k_d (w_dot_d - w_dot) + k_p (w_d - w),   k_d = beta + k_v, k_p = beta k_v
///   q_dd_n   = d/dt(-alpha W^-1 dH/dq) + k_v (-alpha W^-1 dH/dq - q_dot)
/// and the command is the integrated q_dd. s_n and s_t are what null space and tool have of the
/// contact point's velocity beside the free motion that (1) would command; they are read off the
/// previous command, so that what limits or a stop took is not remembered. k_v leaves them alone;
/// they follow the target dynamics of the point's displacement y away from the obstacle:
///   s_n_dot = F_p / (T^2 c) - (2 d / T) y_dot - gamma x_dd_eff         where x_dot_eff < 0
///   s_t_dot = (F_p - F_act) / (T^2 c) - (2 d / T) y_dot                null_task only
/// with y_dot = a^T q_dot = -F_dot / c_e: nothing is differentiated. The terms in y_dot count in
/// contact only. s_n goes to the feedforward of (5), -x_ff, with k_v where it is less, and without
/// contact fades to it as V does. s_t >= 0 begins to grow where F_p passes F_act, and ends at 0.
// clang-format on
class AccelerationLaw {
 public:
  /// Throws std::invalid_argument for a variant that has no such law, or another order than 2.
  explicit AccelerationLaw(const ForceControlConfig& config);

  /// motion: the free one of (1); becomes what the integrated q_dd makes of the previous command
  /// but for the contact's part, which the output asks for in the units of ControlLaw: u = -s / k.
  /// curvature_m_per_s2: F^^T J_p_dot q_dot. Of the state only It is used: s_t, while it is open.
  void update(const ForceGains& gains, const ControlLawInput& input, double curvature_m_per_s2,
              const FreeAcceleration& free, const TaskKinematics& kinematics,
              const ContactSpace& space, double period_s, ControlLawState& state, Motion& motion,
              ControlLawOutput& output) const noexcept;

 private:
  bool has_task_space_;
};

/// The share of k_v in a cycle.
double velocityShare(const ForceGains& gains, double period_s) noexcept;

}  // namespace tactus
