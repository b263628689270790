#pragma once

#include "tactus/math/types.h"
#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus {

/// The motion equation (1) seen along the contact force, (16)-(19). With a = J_p^T F^ and
/// b = W^-1 a, which for W = I is the paper's form:
///   k_j = a^T b,   k_t = a^T J# J b,   k_n = a^T N b,   x_dot_eff = a^T J# w_dot_d,eff
/// F^ is the unit force on the robot, so x_dot_eff < 0 is a motion towards the obstacle.
/// With b, and not a, as the right factor k_n and k_t are squared lengths of orthogonal parts of
/// W^-1/2 a: never negative, and k_n + k_t = k_j, for every W.
struct ContactSpace {
  ScaledVector a_scaled;    ///< W^-1/2 a
  PaddedTaskVector a_task;  ///< Q^T W^-1/2 a, the part that the task space sees
  double k_n = 0.0;
  double k_j = 0.0;
  double k_t = 0.0;
  double x_dot_eff_m_per_s = 0.0;
};

/// a: zero beyond the robot's joints; y_eff: solve(w_dot_d,eff) of the pseudoinverse.
void computeContactSpace(const WeightedPseudoinverse& pseudoinverse, const ScaledVector& a,
                         const ScaledVector& inv_sqrt_weights, const PaddedTaskVector& y_eff,
                         ContactSpace& contact) noexcept;

/// 1 / max(k, 1e-3 k_j, 1e-4 m^2): where a space hardly moves the contact point, its controller
/// must not answer with unbounded speed.
double invertRegularised(double k, double k_j) noexcept;

}  // namespace tactus
