#pragma once

#include "tactus/control/gains.h"
#include "tactus/math/filter.h"

namespace tactus {

/// Beyond it obstacles count as still: a wrong speed costs too much force there, and a right one is
/// too slow to be told.
inline constexpr double kSoftContact_N_per_m = 20e3;

struct ObstacleSpeedState {
  double v_m_per_s = 0.0;   ///< v_o towards the arm, >= 0
  double F_before_N = 0.0;  ///< F_p of the newest sample
  double high_s = 0.0;      ///< for which the force has stayed above what it should fall to
  KnownLagShare filter;
};

/// A force sample in contact, and what the limit made of the samples before it.
struct ObstacleSample {
  double F_p_N = 0.0;       ///< > 0
  double m_N_per_m = 0.0;   ///< stiffness that the limit reckons with
  double dx_m = 0.0;        ///< as sensed, since the sample before, towards the obstacle
  double interval_s = 0.0;  ///< since the sample before
  bool is_limiting = false;
};

// clang-format off: equations
/// The speed at which a soft obstacle comes, to be taken off v_max: for it the force at rest is
/// F_act + T m (v_o - v), and on one that stands still F_act. With F_l = F_act + F_th, at each
/// force sample, with kappa = 1 - exp(-dt / 5T):
///   limiting and F_p > F_act + 0.1 F_l for 3T:  v += kappa ((dF_p / m - dx) / dt - v)
///   F_p < F_act:                                v -= kappa v; v = 0 where the arm is held
///   0 <= v <= 0.5 F_l / (T m);  v = 0 for m > 20 kN/m
/// So it never costs more force than half of F_l, and for m = c_e is nothing where the limit
/// does what it shall. Derivation and figures: docs/approach_speed_limit.md.
// clang-format on
void followObstacle(const ForceGains& gains, const ObstacleSample& sample,
                    ObstacleSpeedState& state) noexcept;

}  // namespace tactus
