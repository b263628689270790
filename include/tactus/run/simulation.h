#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "tactus/record/run_summary.h"
#include "tactus/scene/scene.h"

namespace tactus {

struct SimulationResult {
  RunFigures figures;
  double real_time_factor = 0.0;  ///< simulated time over the time it took, log and plant included
};

/// Told now and then how far a run has come, 0 to 1.
using Progress = std::function<void(double share)>;

/// Given every cycle of a run.
using CycleSink = std::function<void(const CycleRecord& record)>;

/// To take memory for ahead. Longer runs pay for theirs as they go.
std::size_t cyclesToReserve(const Scene& scene);

/// Runs a scene in virtual time. A fault ends the run as soon as the arm is at rest.
SimulationResult simulate(const Scene& scene, const CycleSink& sink,
                          FigureSet set = FigureSet::kAll);

/// The same, and logs every cycle to log_path. Throws InputError or RunError if the log can't be
/// written.
SimulationResult simulate(const Scene& scene, const std::string& log_path,
                          const Progress& progress);

}  // namespace tactus
