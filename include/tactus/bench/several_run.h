#pragma once

#include <array>

#include "tactus/bench/judged_run.h"

namespace tactus {

/// How a run went with the contacts of several modules. Forces are true ones.
struct SeveralRun {
  struct Module {
    double peak_N = 0.0;          ///< of the sum of its contacts
    double contact_peak_N = 0.0;  ///< of each by itself
    int posts = 0;                ///< that touched it
    /// What no law could avoid, see naturalScale(): the largest of all touches of this
    /// module, but for bounces. No module feels friction along its link, nor does its law: with a
    /// coefficient mu, sqrt(1 + mu^2) times that.
    double scale_N = 0.0;
    double restlessness_N = 0.0;  ///< standard deviation over the last JudgedRun::kRest_s
    double mean_at_rest_N = 0.0;  ///< over them
    double peak_at_rest_N = 0.0;
    bool was_touched = false;
  };

  std::array<Module, kMaxTactileModules> modules;
  double largest_peak_to_scale = 0.0;
  double contact_peak_to_scale = 0.0;  ///< of a single contact; the sum hides what is opposed
  int touched_posts = 0;               ///< most on one module
  double restlessness_N = 0.0;         ///< largest
  double peak_at_rest_N = 0.0;         ///< largest
  double limit_N = 0.0;                ///< F_act + F_th, with what is not felt of friction
  int touched_modules = 0;
  double tcp_error_final_m = 0.0;
  /// Largest change of a joint's acceleration times the period, rad/s, while no module had a new
  /// sample.
  double step_between_samples = 0.0;
  double clearance_left_m = kNoLimit;  ///< least, of the commanded joints, beyond the safe distance
  bool is_out = false;                 ///< see EndWatch
  Fault fault = Fault::kNone;
};

SeveralRun runSeveral(const RunSetup& setup);

}  // namespace tactus
