#pragma once

#include <optional>

#include "tactus/analysis/contact_loop.h"
#include "tactus/sim/obstacle.h"

namespace tactus {

/// What an arm under force control meets.
struct TouchedSpring {
  ContactLoop loop;  ///< its delays alone count
  double threshold_N;
  ContactSpring spring;
};

// clang-format off: equations
/// Largest force of a first touch at a constant speed v > 0 along the normal, N. Nothing answers
/// until a sample shows more than F_th (of a law of one space F_th + F_eng); with it the
/// feedforward of (5) takes the whole of v off, and the drives' lag carries the arm on. So the
/// force F(x) of the spring grows to
///   F_peak = F(v t_delay),   t_delay = t_filter + (T_s - T_f) / 2 + (T_c - T_f) / 2 + T_drive
/// with t_filter until the filter, fed with F(v t), passes F_th; half a sample period, for the age
/// of the first sample that shows it; half a cycle, if that is longer than the filter's period;
/// and T_drive, the drives' lag. For a linear spring it is c_e v t_delay; T, d and c of the law are
/// not in it. It is what a contact point comes to that the law can move freely; one that gives way
/// in a part of its directions, or into which other joints push, comes to more.
// clang-format on
double touchPeak_N(const TouchedSpring& touched, double speed_m_per_s);

/// t_delay of it, s.
double touchDelay_s(const TouchedSpring& touched, double speed_m_per_s);

/// The speed below which a first touch stays below this force, m/s; 0 for a force up to F_th.
double touchSpeed_m_per_s(const TouchedSpring& touched, double force_N);

/// The lowest cutoff of the sensor's filter above its present one with which a first touch at this
/// speed stays below this force, Hz; absent if there is none up to 0.4 times its rate.
std::optional<double> touchCutoff_hz(TouchedSpring touched, double speed_m_per_s, double force_N);

/// Force of a blow: a free mass m at speed v against a spring k, by m v^2 / 2 = F^2 / (2 k), N.
double blowPeak_N(double speed_m_per_s, double stiffness_N_per_m, double mass_kg);

/// Of an obstacle that would push with standing_N if it did not slide, N.
double pushOf_N(const ObstacleConfig& obstacle, double standing_N);

}  // namespace tactus
