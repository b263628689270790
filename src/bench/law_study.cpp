#include <algorithm>
#include <string>

#include "tactus/bench/base_scene.h"
#include "tactus/bench/drawn_environments.h"
#include "tactus/bench/law_grid.h"
#include "tactus/bench/law_trials.h"
#include "tactus/bench/parallel.h"
#include "tactus/bench/study.h"

namespace tactus {
namespace {

constexpr const char* kLawBase = "/scenario2_estimated.yaml";
constexpr const char* kOtherArm = "/robots/kuka_iiwa7_contact.yaml";
constexpr std::uint64_t kEnvironmentsSeed = 20'261'124;
constexpr int kEnvironments = 300;

std::vector<LawGridRow> runGrid(const RunSetup& base, const std::vector<LawGridPoint>& points,
                                const LawTrial& trial) {
  std::vector<LawGridRow> rows(points.size());
  inParallel(points.size(),
             [&](std::size_t i) { rows[i] = runLawGridPoint(base, points[i], trial.change); });
  return rows;
}

Plot peaks(const Table& grid) {
  Plot plot;
  plot.title = "Peak force over what no law could avoid";
  plot.note = "A point each for band, profile, arm and speed; on the line y = x nothing is left.";
  plot.table = grid.name;
  plot.x_column = "natural_scale_N";
  plot.y_column = "peak_force_N";
  plot.x_label = "natural scale, N";
  plot.y_label = "peak force, N";
  plot.has_lines = false;
  for (const char* law : {"assumed", "estimated", "limited"})
    plot.series.push_back({law, {{"law", std::string(law)}}});
  return plot;
}

Table drawnEnvironments(const BenchOptions& options, const RunSetup& base) {
  const int count = options.is_quick ? 5 : kEnvironments;
  Table table = emptyDrawnTable();
  addDrawnRow("of the scene", drawEnvironments(base, kEnvironmentsSeed, count), table);
  const RunSetup other = setupOf(loadBase(options.scenes_folder + kOtherArm, {}));
  addDrawnRow("kuka_iiwa7", drawEnvironments(other, kEnvironmentsSeed, count), table);
  return table;
}

}  // namespace

StudyResult studyLaw(const BenchOptions& options) {
  const std::string path =
      options.scenes.empty() ? options.scenes_folder + kLawBase : options.scenes.front();
  const RunSetup base = setupOf(loadBase(path, {.obstacles = 2}));
  std::vector<LawGridPoint> points = lawGridPoints(base.plant.robot_stiffness_N_per_m);
  if (options.is_quick) {
    std::size_t i = 0;
    std::erase_if(points, [&](const LawGridPoint&) { return i++ % 20 > 0; });
  }
  std::vector<LawGridRow> undisturbed;
  Table robustness = emptyLawSummary("law_robustness");
  for (const LawTrial& trial : lawDisturbances()) {
    const std::vector<LawGridRow> rows = runGrid(base, points, trial);
    for (const GridLaw law : kAllGridLaws) addLawSummary(trial.name, law, rows, robustness);
    if (undisturbed.empty()) undisturbed = rows;
  }
  Table ablation = emptyLawSummary("law_ablation");
  addLawSummary("complete", GridLaw::kLimited, undisturbed, ablation);
  for (const LawTrial& trial : lawAblations())
    addLawSummary(trial.name, GridLaw::kLimited, runGrid(base, points, trial), ablation);
  const LawGridFigures limited = lawGridFigures(undisturbed, GridLaw::kLimited);
  StudyResult result;
  result.title = "The approach-speed limit beside the paper's law";
  result.text =
      "A soft band, or none, before a profile, with a compliant and a rigid arm, at several "
      "speeds: "
      "the paper's law in both spaces with the assumed stiffness, with Algorithm 1, and "
      "null_limit. "
      "A limit cycle: over the last 2 s the contact's force has a standard deviation above 0.05 N. "
      "The natural scale is what no law could avoid: nothing is seen before the filtered force "
      "passes the threshold, and by then the arm has gone on for the loop's delay. All of it once "
      "more with each disturbance, and null_limit without each part that a value leaves out. Then "
      "starts, paths and posts that were drawn, for this arm "
      "and another. What "
      "the figures mean is in docs/approach_speed_limit.md.";
  result.goals = {
      {"null_limit: limit cycles", 0.0, static_cast<double>(limited.restless)},
      {"null_limit: peak over the natural scale, largest", 1.15, limited.peak_to_scale},
      {"null_limit: peak over the paper's with the assumed stiffness, largest", 1.05,
       limited.peak_to_assumed},
      {"null_limit: runs that end in a fault", 0.0, static_cast<double>(limited.faults)}};
  result.tables = {robustness, ablation, drawnEnvironments(options, base),
                   lawGridTable(undisturbed)};
  result.plots = {peaks(result.tables.back())};
  return result;
}

}  // namespace tactus
