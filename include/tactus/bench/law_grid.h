#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tactus/bench/judged_run.h"
#include "tactus/bench/table.h"

namespace tactus {

/// A soft band, then a stiff profile behind it, at some speed: where laws peak and bounce.
struct LawGridPoint {
  double band_N_per_m = 0.0;  ///< 0: no band
  double profile_N_per_m = 0.0;
  double robot_stiffness_N_per_m = 0.0;
  double speed_factor = 1.0;  ///< of the base's speed
};

/// 240 points: six bands, five profiles, an arm as compliant as the base's and a rigid one, four
/// speeds.
std::vector<LawGridPoint> lawGridPoints(double robot_stiffness_N_per_m);

/// null_task with the assumed stiffness; with Algorithm 1; null_limit with its estimator.
enum class GridLaw { kAssumed, kEstimated, kLimited };
inline constexpr std::array kAllGridLaws = {GridLaw::kAssumed, GridLaw::kEstimated,
                                            GridLaw::kLimited};
inline constexpr int kGridLaws = kAllGridLaws.size();
const char* gridLawName(GridLaw law);

struct LawGridRow {
  LawGridPoint point;
  std::array<JudgedRun, kGridLaws> runs;
  std::array<double, kGridLaws> scale_N;  ///< naturalScale() of each
};

/// The base with a point's obstacles, arm and speed, and a law. base: a scene with a waypoint, a
/// band and a profile behind it (scenario 2), force control and an estimator; foam is taken away,
/// and the sensor's range is not felt.
RunSetup lawGridSetup(const RunSetup& base, const LawGridPoint& point, GridLaw law);

/// change: of each set-up before it runs.
LawGridRow runLawGridPoint(const RunSetup& base, const LawGridPoint& point,
                           const std::function<void(RunSetup&)>& change);

/// Counts and extremes of a law over rows.
struct LawGridFigures {
  int restless = 0;                             ///< limit cycles
  int faults = 0;                               ///< runs that end in one
  double peak_N = 0.0;                          ///< largest true force
  double final_min_N = 0.0, final_max_N = 0.0;  ///< of the runs that come to rest
  double peak_to_scale = 0.0;                   ///< largest
  double peak_to_assumed = 0.0;  ///< largest peak over that of kAssumed at the same point
};
LawGridFigures lawGridFigures(const std::vector<LawGridRow>& rows, GridLaw law);

/// A row for each point and law.
Table lawGridTable(const std::vector<LawGridRow>& rows);

/// Figures over the grid, a row for each trial and law.
Table emptyLawSummary(const std::string& name);
void addLawSummary(const std::string& trial, GridLaw law, const std::vector<LawGridRow>& rows,
                   Table& table);

}  // namespace tactus
