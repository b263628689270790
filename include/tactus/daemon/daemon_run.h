#pragma once

#include <string>

#include "tactus/control/fault.h"
#include "tactus/scene/scene.h"

namespace tactus {

struct DaemonOptions {
  std::string folder;       ///< for <name>/run.ulg and <name>/summary.json; empty: no files
  std::string name;         ///< of the run's folder
  double duration_s = 0.0;  ///< of motion, after which the run ends; 0: until a signal
};

/// Of motion, after which a run ends: at least one, however short it is; 0, never, for 0.
long long motionCycles(double duration_s, double period_s) noexcept;

/// Runs a scene on the robot until a signal that ends or suspends programs, the end of duration_s
/// or a fault, and leaves the arm at rest with its drives disabled. Returns the fault that ended
/// it. Throws RunError, and moves nothing, if buses, lines or real time are not to be had;
/// InputError for the folder.
Fault runDaemon(const Scene& scene, const DaemonOptions& options);

}  // namespace tactus
