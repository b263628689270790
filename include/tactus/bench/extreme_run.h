#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tactus/bench/extreme_case.h"
#include "tactus/bench/table.h"
#include "tactus/control/fault.h"

namespace tactus {

/// A number of the controller's state in the second and in the last tenth of a run: what a run that
/// lasts makes of it.
struct StateNumber {
  std::string name;
  double early_mean = 0.0, early_largest = 0.0;  ///< largest: of the absolute values
  double late_mean = 0.0, late_largest = 0.0;
};

/// How an extreme ended, and what must hold in every one of its cycles.
struct ExtremeRun {
  /// The key by which the scene is refused at load; empty if it is not. Then nothing was run.
  std::string refused_at_load;
  /// The key by which `tactus check` and the daemon refuse its gains; empty if they do not.
  std::string refused_by_check;
  /// "at rest", "limit cycle", "follows noise", "drifts", a fault's name, "refused at load"; where
  /// what must hold does not: "NOT BOUNDED".
  std::string outcome;
  long long cycles = 0;
  long long not_finite_cycles = 0;     ///< command or state holds what is no number
  long long beyond_limits_cycles = 0;  ///< command beyond a limit of velocity, acceleration, place
  long long subnormal_cycles = 0;      ///< state or arithmetic of the step fell below 2.2e-308
  double peak_force_N = 0.0;           ///< of the contact itself, before the sensor
  double peak_reading_N = 0.0;         ///< F_sen
  double final_reading_N = kNotMeasured;  ///< mean of F_sen over the last kRest_s
  double restlessness_N = kNotMeasured;   ///< standard deviation of the contact's force over them
  double final_speed = kNotMeasured;      ///< fastest joint command over them, m/s or rad/s
  double tcp_error_final_m = kNotMeasured;
  Fault fault = Fault::kNone;
  std::vector<StateNumber> state;

  static constexpr double kRest_s = 2.0;
  static constexpr double kMaxRestlessness_N = 0.05;
  static constexpr double kMaxFinalSpeed = 0.02;
  /// Restlessness over that of the force as read, up to which it is the noise that the arm follows.
  static constexpr double kMostNoise = 5.0;

  bool isBounded() const { return not_finite_cycles == 0 && beyond_limits_cycles == 0; }
};

/// base: path of the scene that is changed. duration_share: of the case's own, for a quick look.
/// Throws InputError if the base itself is broken.
ExtremeRun runExtreme(const std::string& base, const ExtremeCase& extreme, const ExtremeLaw& law,
                      double duration_share = 1.0);

}  // namespace tactus
