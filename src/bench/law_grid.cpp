#include "tactus/bench/law_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

constexpr std::array kBands = {0.0, 10.0, 30.0, 60.0, 200.0, 600.0};  // N/m
constexpr std::array kProfiles = {3e3, 7e3, 17e3, 1e5, 1e6};          // N/m
constexpr std::array kSpeedFactors = {0.5, 1.0, 2.4, 5.0};
constexpr double kSettling_s = 4.5;  ///< after the motion's end

}  // namespace

const char* gridLawName(GridLaw law) {
  switch (law) {
    case GridLaw::kAssumed:
      return "assumed";
    case GridLaw::kEstimated:
      return "estimated";
    case GridLaw::kLimited:
      return "limited";
  }
  return "";
}

std::vector<LawGridPoint> lawGridPoints(double robot_stiffness_N_per_m) {
  std::vector<LawGridPoint> points;
  for (const double band : kBands)
    for (const double profile : kProfiles)
      for (const double robot : {robot_stiffness_N_per_m, kNoLimit})
        for (const double speed : kSpeedFactors) points.push_back({band, profile, robot, speed});
  return points;
}

RunSetup lawGridSetup(const RunSetup& base, const LawGridPoint& point, GridLaw law) {
  RunSetup setup = base;
  ForceControlConfig& force = *setup.controller.force_control;
  force.variant = law == GridLaw::kLimited ? Variant::kNullLimit : Variant::kNullTask;
  if (law == GridLaw::kAssumed) force.has_estimator = false;
  setup.controller.tactile_modules.front().max_force_N = kNoLimit;
  setup.plant.modules[0].quantised = false;  // counts have a range
  setup.plant.robot_stiffness_N_per_m = point.robot_stiffness_N_per_m;
  setup.plant.obstacles.back().stiffness_N_per_m = point.profile_N_per_m;
  setup.plant.obstacles.back().foam.clear();
  if (point.band_N_per_m > 0.0) {
    setup.plant.obstacles.front().stiffness_N_per_m = point.band_N_per_m;
  } else {
    setup.plant.obstacles.erase(setup.plant.obstacles.begin());
  }
  TrajectoryConfig& trajectory = setup.controller.task.trajectory;
  Waypoint& line = trajectory.waypoints.front();
  line.speed_m_per_s *= point.speed_factor;
  const double motion_s = trajectory.start_s + line.displacement_m.norm() / line.speed_m_per_s;
  setup.duration_s = std::max(base.duration_s, motion_s + line.ramp_s + kSettling_s);
  return setup;
}

LawGridRow runLawGridPoint(const RunSetup& base, const LawGridPoint& point,
                           const std::function<void(RunSetup&)>& change) {
  LawGridRow row{point, {}, {}};
  for (int i = 0; i < kGridLaws; ++i) {
    RunSetup setup = lawGridSetup(base, point, kAllGridLaws[i]);
    change(setup);
    row.runs[i] = judgeRun(setup);
    row.scale_N[i] = naturalScale(setup, row.runs[i]);
  }
  return row;
}

LawGridFigures lawGridFigures(const std::vector<LawGridRow>& rows, GridLaw law) {
  const int i = static_cast<int>(law);
  LawGridFigures figures;
  figures.final_min_N = std::numeric_limits<double>::infinity();
  figures.final_max_N = -figures.final_min_N;
  for (const LawGridRow& row : rows) {
    const JudgedRun& run = row.runs[i];
    const double peak_N = run.peak_true_force_N;
    figures.faults += run.fault != Fault::kNone;
    figures.peak_N = std::max(figures.peak_N, peak_N);
    figures.peak_to_scale = std::max(figures.peak_to_scale, peak_N / row.scale_N[i]);
    figures.peak_to_assumed =
        std::max(figures.peak_to_assumed, peak_N / row.runs[0].peak_true_force_N);
    if (run.isRestless()) {
      ++figures.restless;
    } else {
      figures.final_min_N = std::min(figures.final_min_N, run.final_force_N);
      figures.final_max_N = std::max(figures.final_max_N, run.final_force_N);
    }
  }
  return figures;
}

Table lawGridTable(const std::vector<LawGridRow>& rows) {
  Table table{"law_grid",
              {"law", "band_N_per_m", "profile_N_per_m", "robot_N_per_m", "speed_factor",
               "peak_force_N", "final_force_N", "restlessness_N", "natural_scale_N",
               "peak_to_scale", "tcp_error_final_mm", "outcome"},
              {}};
  for (const LawGridRow& row : rows) {
    for (int i = 0; i < kGridLaws; ++i) {
      const JudgedRun& run = row.runs[i];
      const bool has_fault = run.fault != Fault::kNone;
      table.rows.push_back({std::string(gridLawName(kAllGridLaws[i])), row.point.band_N_per_m,
                            row.point.profile_N_per_m, row.point.robot_stiffness_N_per_m,
                            row.point.speed_factor, run.peak_true_force_N, run.final_force_N,
                            run.restlessness_N, row.scale_N[i],
                            run.peak_true_force_N / row.scale_N[i], 1e3 * run.tcp_error_final_m,
                            std::string(has_fault          ? faultName(run.fault)
                                        : run.isRestless() ? "limit cycle"
                                                           : "at rest")});
    }
  }
  return table;
}

Table emptyLawSummary(const std::string& name) {
  return {name,
          {"trial", "law", "points", "limit_cycles", "largest_peak_N", "final_min_N", "final_max_N",
           "largest_peak_to_scale", "largest_peak_to_assumed", "faults"},
          {}};
}

void addLawSummary(const std::string& trial, GridLaw law, const std::vector<LawGridRow>& rows,
                   Table& table) {
  const LawGridFigures figures = lawGridFigures(rows, law);
  table.rows.push_back({trial, std::string(gridLawName(law)), static_cast<double>(rows.size()),
                        static_cast<double>(figures.restless), figures.peak_N, figures.final_min_N,
                        figures.final_max_N, figures.peak_to_scale, figures.peak_to_assumed,
                        static_cast<double>(figures.faults)});
}

}  // namespace tactus
