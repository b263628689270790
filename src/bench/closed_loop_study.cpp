#include "tactus/bench/closed_loop_study.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "tactus/bench/study.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

constexpr double kMillisecond = 1e-3;

std::string sceneName(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

bool isStable(const LoopRun& run) { return run.outcome == "stable"; }

void addRun(const std::string& scene, const LoopRun& run, const LoopRun& reference, Table& runs) {
  const RunFigures& figures = run.figures;
  const bool is_reference = &run == &reference;
  const auto toReference = [&](double value, double of_reference) {
    return is_reference ? kNotMeasured : std::abs(value - of_reference);
  };
  // Beyond the step of the traces they are not of the same times.
  const bool is_comparable = !is_reference && run.period_s <= kTraceStep_s;
  runs.rows.push_back(
      {scene, run.period_s / kMillisecond, run.outcome, double(figures.cycles), run.control_time_s,
       run.run_time_s, double(figures.step_time_ns->median), figures.peak_force_N,
       figures.final_force_N, 1e3 * figures.tcp_error_max_m, 1e3 * figures.tcp_error_rms_m,
       toReference(figures.peak_force_N, reference.figures.peak_force_N),
       1e3 * toReference(figures.tcp_error_max_m, reference.figures.tcp_error_max_m),
       is_comparable ? rmsDifference(run.force_N, reference.force_N) : kNotMeasured,
       is_comparable ? 1e3 * rmsDifference(run.tool_error_m, reference.tool_error_m) : kNotMeasured,
       run.ripple_N, run.ripple_Hz});
}

Table emptyRuns() {
  return {"closed_loop",
          {"scene", "period_ms", "outcome", "cycles", "control_time_s", "run_time_s",
           "step_median_ns", "peak_force_N", "final_force_N", "tcp_error_max_mm",
           "tcp_error_rms_mm", "peak_force_to_reference_N", "tcp_error_max_to_reference_mm",
           "force_rms_to_reference_N", "tcp_error_rms_to_reference_mm", "ripple_N", "ripple_Hz"},
          {}};
}

Table emptyStability() {
  return {"closed_loop_stability",
          {"scene", "longest_stable_period_ms", "next_period_ms", "outcome", "ripple_N",
           "ripple_Hz", "refused_from_ms", "refused_key"},
          {}};
}

double nextPeriod(double period_s) {
  return kMillisecond * std::round(period_s / kMillisecond + 1.0);
}

/// The first run that is not stable, on from the runs that are there; without one, the last.
LoopRun findUnstable(const Scene& scene, const std::vector<LoopRun>& runs, double longest_s,
                     double& longest_stable_s) {
  LoopRun run;
  longest_stable_s = kNotMeasured;
  for (std::size_t i = 0;; ++i) {
    if (i >= runs.size() && nextPeriod(run.period_s) > longest_s + 0.5 * kMillisecond) return run;
    run = i < runs.size() ? runs[i] : runWithPeriod(scene, nextPeriod(run.period_s));
    if (!isStable(run)) return run;
    longest_stable_s = run.period_s;
  }
}

void addStability(const std::string& path, const Scene& scene, const std::vector<LoopRun>& runs,
                  double longest_s, Table& table) {
  double stable_s;
  const LoopRun end = findUnstable(scene, runs, longest_s, stable_s);
  double refused_s = kMillisecond;
  while (refused_s < longest_s && refusedKey(path, refused_s).empty())
    refused_s = nextPeriod(refused_s);
  const double next_ms = isStable(end) ? kNotMeasured : end.period_s / kMillisecond;
  table.rows.push_back({sceneName(path), stable_s / kMillisecond, next_ms, end.outcome,
                        end.ripple_N, end.ripple_Hz, refused_s / kMillisecond,
                        refusedKey(path, refused_s)});
}

/// A line a scene.
Plot makePlot(const Table& runs, const char* x_column, const char* x_label, const char* y_column,
              const char* y_label) {
  Plot plot;
  plot.table = runs.name;
  plot.x_column = x_column;
  plot.y_column = y_column;
  plot.x_label = x_label;
  plot.y_label = y_label;
  std::string before;
  for (std::size_t row = 0; row < runs.rows.size(); ++row) {
    const std::string& scene = runs.word(row, "scene");
    if (scene != before) plot.series.push_back({scene, {{"scene", scene}}});
    before = scene;
  }
  return plot;
}

std::vector<Plot> makePlots(const Table& runs) {
  const char* const period = "cycle period in ms";
  Plot peak = makePlot(runs, "period_ms", period, "peak_force_N", "peak force in N");
  peak.title = "Peak force over the period.";
  Plot error = makePlot(runs, "period_ms", period, "tcp_error_max_mm", "largest TCP error in mm");
  error.title = "Largest TCP error over the period.";
  Plot force_convergence = makePlot(runs, "period_ms", period, "force_rms_to_reference_N",
                                    "rms difference of force in N");
  force_convergence.title = "Convergence of the force.";
  force_convergence.note = "Against the same scene with the reference's period.";
  Plot tool_convergence = makePlot(runs, "period_ms", period, "tcp_error_rms_to_reference_mm",
                                   "rms difference of TCP error in mm");
  tool_convergence.title = "Convergence of the TCP error.";
  tool_convergence.note = force_convergence.note;
  Plot precision = makePlot(runs, "control_time_s", "time of all control steps in s",
                            "force_rms_to_reference_N", "rms difference of force in N");
  precision.title = "Error against the cost of a run.";
  precision.note = "From the right: 0.25 ms to 4 ms; error and time are those of the same run.";
  Plot tool_precision =
      makePlot(runs, "control_time_s", "time of all control steps in s",
               "tcp_error_rms_to_reference_mm", "rms difference of TCP error in mm");
  tool_precision.title = "TCP error against the cost of a run.";
  tool_precision.note = precision.note;
  Plot own = makePlot(runs, "run_time_s", "time of the run in s", "tcp_error_rms_mm",
                      "TCP error, rms, in mm");
  own.title = "Each run's own error and time.";
  own.note = "What every run writes into its summary.json; tools/report plots it for any runs.";
  return {peak, error, force_convergence, tool_convergence, precision, tool_precision, own};
}

}  // namespace

LoopTables measureLoops(const std::vector<std::string>& paths, const LoopSizes& sizes) {
  std::vector<Scene> scenes;
  for (const std::string& path : paths)
    scenes.push_back(loadScene(path, {}, SceneUse::kSimulation));
  LoopTables tables{emptyRuns(), emptyStability()};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const LoopRun reference = runWithPeriod(scenes[i], sizes.reference_period_s);
    addRun(scenes[i].name, reference, reference, tables.runs);
    std::vector<LoopRun> runs;
    for (const double period_s : sizes.periods_s) {
      runs.push_back(runWithPeriod(scenes[i], period_s));
      addRun(scenes[i].name, runs.back(), reference, tables.runs);
    }
    addStability(paths[i], scenes[i], runs, sizes.longest_period_s, tables.stability);
  }
  return tables;
}

StudyResult studyClosedLoop(const BenchOptions& options) {
  LoopSizes sizes;
  if (options.is_quick) {
    sizes.reference_period_s = 0.00025;
    sizes.periods_s = {0.001, 0.004};
    sizes.longest_period_s = 0.004;
  }
  const LoopTables tables = measureLoops(options.scenes, sizes);
  StudyResult result;
  result.title = "Closed loop";
  result.text = fmt::format(
      "Each scene simulated with cycles from {} to {} ms; its reference is the same scene at {} "
      "ms. "
      "A scene is stable while no fault ends it and the sensor's force over the last 2 s before "
      "the "
      "end of contact has a standard deviation of at most {} N around its straight trend. "
      "Stability "
      "is looked for also where the loader refuses a period; by which key it does is in the table. "
      "A longer period ages sensor and command; the loop has room for it where the assumed "
      "stiffness "
      "lies above the contact's, and less where it is estimated.",
      sizes.periods_s.front() / kMillisecond, sizes.longest_period_s / kMillisecond,
      sizes.reference_period_s / kMillisecond, kMaxRipple_N);
  result.plots = makePlots(tables.runs);
  result.tables = {tables.stability, tables.runs};
  return result;
}

}  // namespace tactus
