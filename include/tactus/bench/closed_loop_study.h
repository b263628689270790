#pragma once

#include <string>
#include <vector>

#include "tactus/bench/table.h"
#include "tactus/record/run_summary.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// One run of a scene with a cycle of its own.
struct LoopRun {
  double period_s = 0.0;
  /// "stable", "limit cycle", or the name of a fault.
  std::string outcome;
  RunFigures figures;
  double control_time_s = 0.0;  ///< in control steps alone: cycles times their median
  double run_time_s = 0.0;      ///< of the whole run, simulated robot included
  double ripple_N = 0.0;        ///< of F_sen over the last 2 s before the end of the last contact
  double ripple_Hz = 0.0;
  /// Every kTraceStep_s: F_sen (N) and the tool's error (m).
  std::vector<double> force_N, tool_error_m;
};

inline constexpr double kTraceStep_s = 0.004;
/// A ripple above is no rest.
inline constexpr double kMaxRipple_N = 0.05;

/// Also with periods that the loader refuses: what the control loop itself would do.
LoopRun runWithPeriod(const Scene& scene, double period_s);

/// The key by which the loader refuses the scene with this period; empty if it does not.
std::string refusedKey(const std::string& scene_path, double period_s);

/// Standard deviation of `values` around their straight trend, since slow settling is no limit
/// cycle, and how often a second they cross it upwards.
struct Ripple {
  double deviation = 0.0;
  double frequency_Hz = 0.0;
};
Ripple rippleOf(const std::vector<double>& values, double step_s);

/// Root mean square of the difference, as far as both go; not measured if one is empty.
double rmsDifference(const std::vector<double>& a, const std::vector<double>& b);

struct LoopSizes {
  double reference_period_s = 5e-5;
  std::vector<double> periods_s = {0.00025, 0.0005, 0.001, 0.002, 0.004};
  /// From the longest of them on in steps of a millisecond, until a scene is stable no longer.
  double longest_period_s = 0.15;
};

struct LoopTables {
  Table runs;       ///< a row for each scene and period, the reference included
  Table stability;  ///< a row for each scene: longest stable period, and what ends stability
};

/// paths: of scenes. Throws InputError before the first run.
LoopTables measureLoops(const std::vector<std::string>& paths, const LoopSizes& sizes);

}  // namespace tactus
