#include <algorithm>
#include <array>

#include "tactus/bench/base_scene.h"
#include "tactus/bench/parallel.h"
#include "tactus/bench/same_module.h"
#include "tactus/bench/several_grid.h"
#include "tactus/bench/study.h"
#include "tactus/scene/key_words.h"

namespace tactus {
namespace {

constexpr const char* kSeveralBase = "/whole_arm/crops9_skin_rail.yaml";
constexpr std::uint64_t kSeveralSeed = 20'261'125;
constexpr int kSeveralDraws = 600;
constexpr int kPairDraws = 200;

/// What is done to all environments.
struct SeveralTrial {
  const char* name;
  double noise_N, friction, bearable_friction;
};
constexpr std::array kSeveralTrials = {
    SeveralTrial{"alone", 0.0, 0.0, 0.0},
    SeveralTrial{"noise 0.05 N", 0.05, 0.0, 0.0},
    SeveralTrial{"friction 0.3, 0.5 set", 0.0, 0.3, 0.5},
    SeveralTrial{"friction 0.3, 0.5 set, noise 0.05 N", 0.05, 0.3, 0.5},
};

void apply(const SeveralTrial& trial, RunSetup& setup) {
  setup.controller.force_control->friction_coefficient = trial.bearable_friction;
  std::uint64_t seed = 0;
  for (SimulatedModuleConfig& module : setup.plant.modules) {
    module.noise_N = trial.noise_N;
    module.seed = ++seed;
  }
  for (ObstacleConfig& post : setup.plant.obstacles) post.friction_coefficient = trial.friction;
}

bool isOfStaticKind(const std::string& name) {
  for (int kind = 0; kind < kSeveralKinds; ++kind)
    if (name == severalKindName(static_cast<SeveralKind>(kind)))
      return static_cast<SeveralKind>(kind) != SeveralKind::kMoving;
  return false;
}

/// Of all kinds and trials, without posts that move: a force that follows them does not rest.
struct StaticShares {
  double runs = 0, high = 0, restless = 0, most_restless_N = 0.0, largest_rest = 0.0, steps = 0.0,
         alone = 0.0, intrusion_m = 0.0, faults = 0;

  explicit StaticShares(const Table& table) {
    const std::size_t kind = table.column("kind");
    const auto value = [&](const std::vector<Cell>& row, const char* column) {
      return std::get<double>(row[table.column(column)]);
    };
    for (const std::vector<Cell>& row : table.rows) {
      const std::string& name = std::get<std::string>(row[kind]);
      if (!isOfStaticKind(name)) continue;
      runs += value(row, "runs");
      faults += value(row, "faults");
      high += value(row, "peaks_above_1_15");
      restless += value(row, "restless");
      most_restless_N = std::max(most_restless_N, value(row, "largest_restlessness_N"));
      largest_rest = std::max(largest_rest, value(row, "largest_rest_to_limit"));
      intrusion_m = std::max(intrusion_m, value(row, "largest_intrusion_m"));
      if (std::get<std::string>(row[table.column("trial")]) != kSeveralTrials[0].name) continue;
      alone += value(row, "runs");
      steps += value(row, "steps_above_0_02");
    }
  }
};

std::vector<Goal> severalGoals(const Table& table) {
  const StaticShares all(table);
  return {
      {"several contacts: share of peaks above 1.15 of the natural scale", 0.02,
       all.high / all.runs},
      {"several contacts: share that does not come to rest", 0.01, all.restless / all.runs},
      {"several contacts: largest restlessness, N", 0.2, all.most_restless_N},
      {"several contacts: largest true force at rest over F_act + F_th", 1.02, all.largest_rest},
      {"several contacts: share with a step of a joint above 0.02 rad/s between samples, without "
       "noise",
       0.02, all.steps / all.alone},
      {"several contacts: how far the arm came within a safe distance, m", 1e-9, all.intrusion_m},
      {"several contacts: runs that end in a fault", 0.0, all.faults}};
}

/// Two contacts on one module, by where the approach is limited.
Table tryLimitPlaces(const RunSetup& base, int draws) {
  const std::vector<SeveralCase> cases = drawSameModule(base, kSeveralSeed, draws);
  Table table = emptySeveralTable("two_contacts_on_a_module");
  for (const SeveralTrial& trial : {kSeveralTrials[0], kSeveralTrials[1]}) {
    for (const Word<LimitAt>& at : kLimitAtWords) {
      if (at.value == LimitAt::kAuto) continue;
      std::vector<SeveralRun> runs(cases.size());
      inParallel(cases.size(), [&](std::size_t i) {
        RunSetup setup = cases[i].setup;
        apply(trial, setup);
        setup.controller.force_control->limit_at = at.value;
        runs[i] = runSeveral(setup);
      });
      addSeveralRows(at.text + (", " + std::string(trial.name)), cases, runs, table);
    }
  }
  return table;
}

}  // namespace

StudyResult studySeveral(const BenchOptions& options) {
  const std::string path =
      options.scenes.empty() ? options.scenes_folder + kSeveralBase : options.scenes.front();
  const RunSetup base = setupOf(loadBase(path, {.modules = 2}));
  const std::vector<SeveralCase> cases =
      drawSeveral(base, kSeveralSeed, options.is_quick ? 12 : kSeveralDraws);
  StudyResult result;
  result.title = "Several contacts";
  result.text =
      "null_limit on an arm with several tactile modules: starts, paths and two or three posts of "
      "100 to 1e6 N/m that were drawn; before several links at once or in turn, behind a link "
      "where the arm gives way to, on both sides with little room, one that vanishes, one of up "
      "to 7000 N/m that comes and goes with up to 5 mm/s; with nothing else around, with joints "
      "near their limits, beside a bar and itself, or at a wall. Peaks are true forces over what "
      "no law could avoid. Of posts that move no rest is asked for. A second table has two posts "
      "on one module, on the same side, across it and on both sides, by controller.limit_at; its "
      "peaks are those of single contacts. What the figures mean is in "
      "docs/gate.md.";
  Table table = emptySeveralTable("several_contacts");
  for (const SeveralTrial& trial : kSeveralTrials) {
    std::vector<SeveralRun> runs(cases.size());
    inParallel(cases.size(), [&](std::size_t i) {
      RunSetup setup = cases[i].setup;
      apply(trial, setup);
      runs[i] = runSeveral(setup);
    });
    addSeveralRows(trial.name, cases, runs, table);
  }
  result.goals = severalGoals(table);
  RunSetup open = base;
  open.controller.clearance.reset();
  Table pairs = tryLimitPlaces(open, options.is_quick ? 5 : kPairDraws);
  result.tables = {std::move(table), std::move(pairs)};
  return result;
}

}  // namespace tactus
