#pragma once

#include <array>

#include "tactus/control/motion.h"
#include "tactus/math/complementarity.h"

namespace tactus {

/// a^T q_dot >= -v_max: the arm shall not go faster along -a.
struct SpeedRow {
  ScaledVector a_scaled;    ///< W^-1/2 a
  PaddedTaskVector a_task;  ///< Q^T W^-1/2 a
  double v_max_m_per_s = 0.0;
  double damping_N_s_per_m = 0.0;  ///< D = dF/dv: force that costs one m/s too much, > 0
};

/// So many of them, without memory of more.
struct SpeedRows {
  std::array<SpeedRow, kMaxRows> row;
  int size = 0;
};

// clang-format off: equations
/// The least change of a motion q_1 that keeps all rows:
///   q_dot = q_1 + M A^T l,    M = (J#J + kappa N) W^-1,    kappa = 30
///   l >= 0,   K l >= -v_max - A q_1,  complementary,       K = A M A^T
/// So the null space, being cheap, does most of it, and stopping all of it is within reach.
/// Rows that oppose each other (K_ij < 0) may exclude each other. They yield by slack_i = delta_i
/// l_i with delta_i in proportion to 1 / D_i, which is an equilibrium of forces; rows without
/// opponents are exact. From l = 0 four times
///   l <- LCP(K + diag(delta), d + delta l),
///   delta_i = delta_0 / D_i min(1, sum_j o_ij) + 1e-6 K_ii,   o_ij = min(0, K_ij)^2 / (K_ii K_jj)
/// with delta_0 = 1.5 N s m and K_ii at least max(1e-3 |W^-1/2 a_i|^2, 1e-4).
/// Adds M A^T l to the motion and returns l, m/s each m^2.
// clang-format on
RowVector keepSpeedRows(const SpeedRows& rows, int task_size, Motion& motion) noexcept;

}  // namespace tactus
