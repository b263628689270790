#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tactus/bench/parallel.h"
#include "tactus/bench/physics_grid.h"
#include "tactus/bench/study.h"

/// The controller before the built-in plant and before MuJoCo, side by side.
namespace tactus {
namespace {

using physics::Case;
using physics::Comparison;
using physics::Gears;
using physics::Plant;
using physics::Trial;

constexpr const char* kText =
    "The very controller in the paper's scenes, and in scenario 3 with one bare obstacle, before "
    "the "
    "built-in plant and before MuJoCo, which moves the same arm with kinematics, masses, gears, "
    "contacts and friction of its own. Forces are true ones, at rest the mean of the last half "
    "second. "
    "fault: the run ended with one, mostly of the module's range. chaotic: halving its own step "
    "changes "
    "the peak of one plant by more than a tenth; these are not compared.";

double speedOf(const Trial& trial) { return trial.simulated_s / trial.run_time_s; }

std::string word(bool is_true) { return is_true ? "yes" : "no"; }

std::vector<Case> casesOf(bool is_quick) {
  std::vector<Case> cases = physics::contactCases();
  if (is_quick) {
    std::erase_if(cases, [](const Case& one) {
      return one.friction_coefficient > 0.0 || one.stiffness_N_per_m < 1e5;
    });
    return cases;
  }
  for (const auto& more : {physics::paperCases(), physics::otherArmCases()})
    cases.insert(cases.end(), more.begin(), more.end());
  return cases;
}

Table comparisonTable(const std::vector<Case>& cases, const std::vector<Comparison>& all) {
  Table table{"physics",
              {"scene", "gears", "obstacle_N_per_m", "friction_coefficient", "quasi_static_peak_N",
               "peak_N", "mujoco_peak_N", "rest_N", "mujoco_rest_N", "error", "fault", "chaotic",
               "times_real_time", "mujoco_times_real_time"},
              {}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    const Comparison& c = all[i];
    const bool has_fault = c.built_in.fault != Fault::kNone || c.mujoco.fault != Fault::kNone;
    const double stiffness = one.stiffness_N_per_m > 0.0 ? one.stiffness_N_per_m : kNotMeasured;
    table.rows.push_back({one.scene, std::string(gearsName(one.gears)), stiffness,
                          one.friction_coefficient, c.quasi_static.peak_N, c.built_in.peak_N,
                          c.mujoco.peak_N, c.built_in.rest_N, c.mujoco.rest_N, c.error(),
                          word(has_fault), word(c.isChaotic()), speedOf(c.built_in),
                          speedOf(c.mujoco)});
  }
  return table;
}

std::vector<Goal> goalsOf(const std::vector<Comparison>& all) {
  std::vector<double> errors;
  for (const Comparison& one : all)
    if (!one.isChaotic()) errors.push_back(std::abs(one.error()));
  if (errors.empty()) return {};
  std::ranges::sort(errors);
  return {{"peak of the built-in plant against MuJoCo's, error of the median", 0.08,
           errors[errors.size() / 2]},
          {fmt::format("the same, largest of {}; {} are chaotic", errors.size(),
                       all.size() - errors.size()),
           0.25, errors.back()}};
}

struct StepRow {
  Plant plant;
  double step_s;
};

/// Errors of three contacts against MuJoCo with its smallest step, the first of the rows.
Table stepTable(const std::string& scenes_folder) {
  const std::vector<Case> cases = {{"scenario3_tactus", Gears::kRigid, 1e4, 0.0},
                                   {"scenario3_tactus", Gears::kBare, 1e5, 0.0},
                                   {"scenario3_tactus", Gears::kFlexible, 1e6, 0.0}};
  const std::vector<StepRow> rows = {
      {Plant::kMujoco, 0.0000625}, {Plant::kMujoco, 0.000125},   {Plant::kMujoco, 0.00025},
      {Plant::kMujoco, 0.0005},    {Plant::kBuiltIn, 0.0000625}, {Plant::kBuiltIn, 0.000125},
      {Plant::kBuiltIn, 0.00025},  {Plant::kBuiltIn, 0.0005},    {Plant::kBuiltIn, 0.001}};
  std::vector<Trial> trials(rows.size() * cases.size());
  inParallel(trials.size(), [&](std::size_t i) {
    const StepRow& row = rows[i / cases.size()];
    trials[i] = tryOut(sceneOf(cases[i % cases.size()], scenes_folder), row.plant, row.step_s);
  });
  Table table{"physics_steps",
              {"plant", "step_s", "scene", "gears", "obstacle_N_per_m", "peak_N", "error",
               "times_real_time"},
              {}};
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const StepRow& row = rows[i / cases.size()];
    const Case& one = cases[i % cases.size()];
    const double exact_N = trials[i % cases.size()].peak_N;
    table.rows.push_back({std::string(row.plant == Plant::kMujoco ? "mujoco" : "built_in"),
                          row.step_s, one.scene, std::string(gearsName(one.gears)),
                          one.stiffness_N_per_m, trials[i].peak_N, trials[i].peak_N / exact_N - 1.0,
                          speedOf(trials[i])});
  }
  return table;
}

}  // namespace

StudyResult studyPhysics(const BenchOptions& options) {
  const std::vector<Case> cases = casesOf(options.is_quick);
  std::vector<Comparison> all(cases.size());
  inParallel(cases.size(),
             [&](std::size_t i) { all[i] = physics::compare(cases[i], options.scenes_folder); });
  StudyResult result{"A second opinion: MuJoCo", kText, goalsOf(all), {}, {}};
  result.tables.push_back(comparisonTable(cases, all));
  if (!options.is_quick) result.tables.push_back(stepTable(options.scenes_folder));
  return result;
}

}  // namespace tactus
