#pragma once

#include "tactus/control/gains.h"
#include "tactus/math/types.h"

namespace tactus {

struct ContactTransitionState {
  bool touched = false;                  ///< has there been contact at all?
  Vector3 p_BaseLost = Vector3::Zero();  ///< where the contact point was last in contact, m
  double gamma = 0.0;                    ///< share of the feedforward in (5)
};

/// What becomes of feedforward and integral when contact is lost and found ("continuous feedforward
/// compensation"; the paper names only the parameters T_t,max and d_t):
///   delta = |p - p_lost|,   g = max(0, 1 - delta / d_t),   T_t = T_t,max g
///   without contact:  gamma goes to g, and the integral V to zero, with time constant T_t
///   in contact:       gamma = 1, reached over F_p = 0 .. engage_force_N
/// Returns the factor by which the integral V decays in this cycle (1 in contact).
double passTransition(const ContactTransitionGains& gains, double F_p_N,
                      const Vector3& p_BaseContact, double period_s,
                      ContactTransitionState& state) noexcept;

}  // namespace tactus
