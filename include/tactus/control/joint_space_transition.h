#pragma once

#include "tactus/control/contact_point.h"
#include "tactus/control/gains.h"
#include "tactus/math/filter.h"

namespace tactus {

struct JointSpaceTransitionState {
  bool touching = false;                 ///< contact, with hysteresis
  double gamma = 0.0;                    ///< share of the feedforward
  double kappa = 0.0;                    ///< share of the pull towards the path
  bool has_rested = false;               ///< and kappa has not come back to where it goes
  Vector3 p_BaseLost = Vector3::Zero();  ///< where the contact point was last touching, m
  ContactPointState contact;             ///< point and direction that the law uses
  KnownLagShare response, fade;          ///< with T, and with T_t,max
};

/// What a cycle needs to know of the contact besides its force.
struct JointSpaceTransitionInput {
  double F_p_N = 0.0;
  Vector3 p_BaseContact = Vector3::Zero();  ///< m
  double x_dot_free_m_per_s = 0.0;          ///< x_0, see below
};

/// How the integral of (5) enters in this cycle: V = decay V, and share V of it.
struct IntegralShare {
  double decay = 1.0;
  double share = 1.0;
};

// clang-format off: equations
/// Contact transition of the joint-space variant. There the tool leaves its path, and beta = 500
/// pulls it back against the obstacle at up to a hundred metres a second: joints are driven onto
/// their limits, and shoot back when the obstacle is gone. And the arm is meant to rest *below*
/// F_th (the paper's 0.7 N), where the plain transition lets the feedforward fade. So the motion of
/// (1) is taken apart into what also happens without contact, and the pull:
///   q_free = J# (w_dot_d + beta (w_d - w)) - N alpha W^-1 dH/dq       beta = 5 as elsewhere
///   q_pull = J# beta_pull (w_d - w), scaled as a whole to the null-space speed limits, and by
///            (1 - s_max^2), s_max in 0..1 telling how near the nearest joint is to its limit
///   x_0 = a^T q_free,  x_p = a^T q_pull              both < 0 towards the obstacle
///   q_dot = q_free + kappa q_pull - b u_j
///   u_j = (min(0, gamma x_0 + kappa x_p) - P F_p - sigma V) / k_j
/// The last is (5) with the whole residual motion, that of the joint-limit cost included, as its
/// feedforward.
/// Contact begins at F_th and ends only when F_sen falls below F_rel ("nothing is felt"):
///   engage, F_p > 0:   dgamma/dt = (1 - gamma) (F_p / F_eng)^2 / T;  F_eng = 0: gamma = 1 at once
///   between:           gamma stays; V decays with T_t,max and enters with
///                      sigma = clamp((F_sen - F_rel) / (F_th - F_rel), 0, 1), so that it never
///                      pushes the arm off the obstacle
///   release, F_sen < F_rel:  V = 0, and with delta = |p - p_lost|
///                      g = max(0, 1 - delta / d_t - v_search / max(|x_0|, v_search)),
///                      gamma falls to g with T: the arm goes back to where contact was lost, at
///                      v_search first and faster the further away that is
///   kappa rises to gamma with T while touching, and falls, else to 0, with T_t,max: the pull acts
///   in contact only, and lets go gently.
/// Point and direction of contact are low-passed with T once gamma > 0, and frozen below F_rel.
/// Where the arm rests between F_rel and F_th is not regulated: it follows from the integral that
/// the engagement fills and T_t,max empties.
// clang-format on
/// Takes over the sensor's point and direction; call before passTransition(). is_moving: false
/// while the arm rests whatever the law says; then at once, as there is nothing to be smoothed.
void followContact(const ForceGains& gains, const ContactPointState& sensor, bool is_moving,
                   double period_s, JointSpaceTransitionState& state) noexcept;

IntegralShare passTransition(const ForceGains& gains, const JointSpaceTransitionInput& input,
                             double period_s, JointSpaceTransitionState& state) noexcept;

/// In place of passTransition(), in a cycle in which the arm rests whatever the law says.
void restTransition(JointSpaceTransitionState& state) noexcept;

}  // namespace tactus
