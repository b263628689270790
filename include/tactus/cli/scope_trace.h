#pragma once

#include <string>
#include <vector>

#include "tactus/analysis/predicted_touch.h"
#include "tactus/record/capture_ring.h"
#include "tactus/record/touch_fit.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A curve over the time since the trigger.
struct ScopeCurve {
  std::vector<double> t_s, value;
};

/// What is shown of a capture.
struct ScopeTrace {
  double trigger_s = 0.0;  ///< time of the log
  bool is_triggered = true;
  std::string link;  ///< of the module that felt most
  std::string variant;
  ForceGains gains;                    ///< at the trigger
  double law_stiffness_N_per_m = 0.0;  ///< c, when F_sen passed F_th; else at the trigger
  /// Where it shall rest: F_act + F_th, or F_th of a law without F_act; NaN without a law.
  double rest_N = 0.0;
  double peak_N = 0.0;
  TouchFit touch;
  ScopeCurve force;      ///< F_sen, N
  ScopeCurve signal;     ///< of the trigger
  ScopeCurve predicted;  ///< by predictForce(), passes F_th where F_sen does; may be empty
  std::string why_not_predicted;
};

inline constexpr double kDrawnBand = 0.05;  ///< of rest_N, to each side; settling_s is of another

/// capture has cycles.
ScopeTrace scopeTrace(const Scene& scene, const TriggerCondition& condition,
                      const Capture& capture);

/// What a prediction has in it, and what not; goes on from "predicted: ".
inline constexpr const char* kPredictionText =
    "what the loop that tactus check judges (cycle, hold, filter, drives' lag, T, d, c, F_th, "
    "F_act, "
    "feedforward) does when it meets a spring of c_e at the speed of the touch. Not in it: limits, "
    "a "
    "null space that ends, joint-limit cost, estimator, friction, masses, gears, other contacts.";

/// "T 0.1 s, d 0.5, F_act 3.8 N, F_th 1.2 N, c 7000 N/m".
std::string gainsText(const ScopeTrace& trace);
/// "c_e 1092 (1091..1092) N/m met with 0.033 m/s", or that it is not known.
std::string touchText(const ScopeTrace& trace);

/// What is dashed: the force where it shall rest.
std::string restText(const ScopeTrace& trace);

Json scopeJson(const ScopeTrace& trace);

/// At most about so many points, of each stretch the lowest and the highest.
ScopeCurve thinned(const ScopeCurve& curve, std::size_t most);

}  // namespace tactus
