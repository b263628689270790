#include "tactus/control/contact_transition.h"

#include <algorithm>

#include "tactus/math/filter.h"

namespace tactus {

double passTransition(const ContactTransitionGains& gains, double F_p_N,
                      const Vector3& p_BaseContact, double period_s,
                      ContactTransitionState& state) noexcept {
  if (F_p_N > 0.0) {
    const double engaged = F_p_N < gains.engage_force_N ? F_p_N / gains.engage_force_N : 1.0;
    state.gamma = std::max(state.gamma, engaged);
    state.p_BaseLost = p_BaseContact;
    state.touched = true;
    return 1.0;
  }
  if (!state.touched) return 0.0;
  const double delta_m = (p_BaseContact - state.p_BaseLost).norm();
  const double g = std::max(0.0, 1.0 - delta_m / gains.distance_m);
  const double share = lagShare(period_s, gains.max_time_constant_s * g);
  state.gamma += share * (g - state.gamma);
  return 1.0 - share;
}

}  // namespace tactus
