#pragma once

#include "tactus/control/gains.h"
#include "tactus/math/filter.h"

namespace tactus {

struct StiffnessEstimatorState {
  double stiffness_N_per_m = 0.0;      ///< c; to be set to c_0 at first
  double stiffness_raw_N_per_m = 0.0;  ///< c_raw, likewise
  double x_int_m = 0.0;
  double v_prev_m_per_s = 0.0;
  double F_prev_N = 0.0;
  KnownLagShare filter;
};

/// Algorithm 1 of the paper, with what it leaves open decided so: the filter is discretised exactly
/// and frozen while the contact point does not approach; then, and at zero force, the integrator
/// restarts; a trigger after less than 1e-6 m of approach gives no estimate; c_raw is clamped.
/// F_p_N: contact force; approach_m_per_s: v_p,d of (15), positive towards the obstacle, of the
/// previous cycle's command.
void estimateStiffness(const StiffnessEstimatorGains& gains, double F_p_N, double approach_m_per_s,
                       double period_s, StiffnessEstimatorState& state) noexcept;

}  // namespace tactus
