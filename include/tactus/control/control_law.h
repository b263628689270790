#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/null_speed_limit.h"
#include "tactus/math/contact_space.h"

namespace tactus {

struct ControlLawState {
  double V_m_per_s = 0.0;  ///< integral of (5), stored as int F_p / (T^2 c) dt
  /// Windowed integral of (7), stored likewise; 0 without a second space. At the acceleration level
  /// s_t of acceleration_law.h, within that window.
  double It_m_per_s = 0.0;
  NullSpeedLimits null_speed;
};

struct ControlLawInput {
  double F_p_N = 0.0;              ///< of null_limit also below 0, see ControlLaw
  double stiffness_N_per_m = 0.0;  ///< c
  double x_dot_ff_m_per_s = 0.0;   ///< gamma min(x_dot_eff, 0)
  double integral_decay = 1.0;     ///< of V in this cycle, from the contact transition
  double integral_share = 1.0;     ///< of V that acts, likewise
  bool hold_integral = false;      ///< V holds: another space does its work
  bool is_followed = true;         ///< false: the arm stops or rests, whatever u says
  double cut_m_per_s = 0.0;        ///< of the contact point's retreat, by limits, a cycle ago
};

/// Scalar controller outputs, 1/(m s) each: u_q = b u moves the contact point by -k u.
struct ControlLawOutput {
  double u_n = 0.0, u_j = 0.0, u_t = 0.0;
};

/// F_p of null_limit's null-space law, to be taken times gamma where it is negative: below F_th,
/// where the contact is still felt, the arm has gone back too far, -min(F_th - F_sen, F_sen -
/// F_rel), else F_p.
double signedContactForce_N(const ForceGains& gains, double force_N) noexcept;

/// The paper's laws. One space, (5), with 1/k regularised and P = 2 d / (T c):
///   u = (x_ff - P F_p - V) / k,     dV/dt = F_p / (T^2 c)
/// Second space of the multi-space variants, (7), one-sided as a sum:
///   u = -max(0, P (F_p - F_act) + I) / k,   dI/dt = (F_p - F_act) / (T^2 c), I >= 0
/// First-order target dynamics: P = 1 / (T c), no integrals. The null-space output is limited: b
/// u_n is scaled as a whole so that no component exceeds its speed, and V holds meanwhile.
/// Integrals remember nothing that would move the arm later:
///   not followed:  V and I may fall, but not grow; where F_p = 0, V fades with T_t,max
///   cut:           dV/dt = min(0, F_p / (T^2 c) - x_cut / T) down to V = 0; x_cut > 0 is the part
///                  of the contact point's retreat that the arm's limits cut off a cycle ago; I
///                  likewise, with F_p - F_act; V also while another space does its work, which
///                  else holds it
/// kNullLimit: u_n alone, with the signed F_p, and V does not fade where that is negative but
/// falls, as far as 0; what u_n lacks is added by approach_limit.h.
class ControlLaw {
 public:
  ControlLaw(const ForceControlConfig& config, const SerialChain& chain,
             const ScaledVector& inv_sqrt_weights);

  void update(const ForceGains& gains, const ControlLawInput& input, const ContactSpace& space,
              double period_s, ControlLawState& state, ControlLawOutput& output) const noexcept;

  const NullSpeedLimit& nullSpeedLimit() const noexcept { return null_speed_limit_; }

 private:
  double proportionalGain(const ForceGains& gains, double stiffness_N_per_m) const noexcept;

  Variant variant_;
  int order_;
  bool has_null_space_;
  bool has_second_space_;
  NullSpeedLimit null_speed_limit_;
};

}  // namespace tactus
