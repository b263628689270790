#pragma once

#include "tactus/control/fault.h"
#include "tactus/scene/scene.h"

namespace tactus::physics {

/// How a run of a scene went in one plant, true forces of module 0.
struct Trial {
  double peak_N = 0.0;
  double rest_N = 0.0;         ///< mean of the last half second before its end
  double tool_error_m = 0.0;   ///< largest
  double run_time_s = 0.0;     ///< of plant and controller, the processor's
  double simulated_s = 0.0;    ///< until its end, or the first fault
  Fault fault = Fault::kNone;  ///< with which it ended, if any
};

enum class Plant { kBuiltIn, kMujoco };

/// The scene's controller with one of the plants; step_s: of the integration, 0 for its own.
/// Throws std::runtime_error where MuJoCo's state is lost.
Trial tryOut(const Scene& scene, Plant plant, double step_s = 0.0);

}  // namespace tactus::physics
