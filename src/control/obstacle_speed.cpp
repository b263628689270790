#include "tactus/control/obstacle_speed.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kHigh = 0.1;  ///< of F_l: no noise, and more than a wrong contact point costs
/// Of T: on what stands still, and for m = c_e, the force has fallen by then.
constexpr double kSettling = 3.0;
constexpr double kSmoothing = 5.0;  ///< of T
constexpr double kMaxShare = 0.5;   ///< of F_l

}  // namespace

void followObstacle(const ForceGains& gains, const ObstacleSample& sample,
                    ObstacleSpeedState& state) noexcept {
  const double T_s = gains.time_constant_s;
  const double m = sample.m_N_per_m;
  const double dF_N = sample.F_p_N - state.F_before_N;
  state.F_before_N = sample.F_p_N;
  const double excess_N = sample.F_p_N - gains.activation_force_N;
  const double limit_N = gains.activation_force_N + gains.contact_threshold_N;
  const bool is_high = sample.is_limiting && excess_N > kHigh * limit_N;
  state.high_s = is_high ? state.high_s + sample.interval_s : 0.0;
  if (m > kSoftContact_N_per_m) {
    state.v_m_per_s = 0.0;
    return;
  }
  double target_m_per_s = state.v_m_per_s;
  if (excess_N < 0.0) {
    target_m_per_s = 0.0;
  } else if (state.high_s > kSettling * T_s) {
    target_m_per_s = (dF_N / m - sample.dx_m) / sample.interval_s;
  }
  const double kappa = state.filter.of(sample.interval_s, kSmoothing * T_s);
  const double v_m_per_s = state.v_m_per_s + kappa * (target_m_per_s - state.v_m_per_s);
  state.v_m_per_s = std::clamp(flushed(v_m_per_s), 0.0, kMaxShare * limit_N / (T_s * m));
}

}  // namespace tactus
