#pragma once

#include <functional>

#include "tactus/control/controller_config.h"
#include "tactus/control/fault.h"
#include "tactus/control/robot.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// A controller in a world, for as long as it takes.
struct RunSetup {
  ControllerConfig controller;
  PlantConfig plant;
  double period_s = 0.001;
  double duration_s = 13.0;
  /// Of what gives way in plant.dynamics, gears and servos; only for naturalScale().
  double arm_stiffness_N_per_m = kNoLimit;
  /// What the tactile module says instead of what it felt; empty: just that.
  std::function<void(TactileSample& sample)> reading{};
  /// Told of each cycle's joints as measured; empty: nobody.
  std::function<void(const JointVector& q, double t_s)> watch{};
};

/// How a run went with its last obstacle, the profile. Forces are the sensor's.
struct JudgedRun {
  double peak_force_N = 0.0;
  double peak_true_force_N = 0.0;  ///< of the contact itself
  double final_force_N = 0.0;      ///< mean over the last kRest_s
  double restlessness_N = 0.0;     ///< standard deviation of the true force over them
  double peak_at_rest_N = 0.0;     ///< of the true force, likewise
  double tcp_error_final_m = 0.0;
  /// When the profile was first touched: the speed against it, and F_p of what was already there.
  double touch_speed_m_per_s = 0.0;
  double touch_force_N = 0.0;
  double touch_mass_kg = 0.0;  ///< that it then met with; 0 where the arm has none
  Fault fault = Fault::kNone;  ///< of the last cycle

  static constexpr double kHighPeak = 1.15;  ///< over the natural scale
  static constexpr double kRest_s = 2.0;
  static constexpr double kMaxRestlessness_N = 0.05;
  bool isRestless() const { return !(restlessness_N <= kMaxRestlessness_N); }
};

JudgedRun judgeRun(const RunSetup& setup);

/// Time from a motion of the command to the law that sees its force: drives, filter, and the mean
/// age of a sample.
double feedbackDelay_s(const PlantConfig& plant);

/// What no law could avoid: nothing is seen before the filtered force passes F_th, and by then the
/// arm has gone on for the delay; the blow v sqrt(k m) of an arm with mass; and what is asked for,
/// F_act. N.
double naturalScale(const RunSetup& setup, const JudgedRun& run);

}  // namespace tactus
