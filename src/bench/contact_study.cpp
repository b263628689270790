#include <algorithm>
#include <cmath>
#include <string>

#include "tactus/bench/law_grid.h"
#include "tactus/bench/parallel.h"
#include "tactus/bench/study.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

constexpr const char* kContactBase = "/scenario2_estimated.yaml";
constexpr std::array kContactBands = {0.0, 30.0, 200.0};           // N/m
constexpr std::array kContactProfiles = {3e3, 17e3, 1e5, 1e6};     // N/m
constexpr std::array kContactSpeeds = {1.0, 2.4};                  // of the base's
constexpr std::array kFrictions = {0.0, 0.1, 0.2, 0.3, 0.5, 0.6};  // mu
constexpr std::array kBearables = {0.0, 0.5, 0.8};                 // mu_max
constexpr std::array kNoises_N = {0.0, 0.05};

struct ContactTrial {
  double friction = 0.0;
  double noise_N = 0.0;
  double bearable = 0.0;
};

struct ContactFigures {
  int restless = 0;
  int high = 0;  ///< peaks above kMaxRatio
  double peak_to_scale = 0.0, rest_to_limit = 0.0;
  double tcp_error_m = 0.0;
  static constexpr double kMaxRatio = 1.3;

  void add(const RunSetup& setup, const JudgedRun& run) {
    const ForceGains& force = setup.controller.gains.force;
    const double limit_N = force.activation_force_N + force.contact_threshold_N;
    const double ratio = run.peak_true_force_N / naturalScale(setup, run);
    restless += run.isRestless() ? 1 : 0;
    high += ratio > kMaxRatio ? 1 : 0;
    peak_to_scale = std::max(peak_to_scale, ratio);
    rest_to_limit = std::max(rest_to_limit, run.final_force_N / limit_N);
    tcp_error_m = std::max(tcp_error_m, run.tcp_error_final_m);
  }
};

std::vector<LawGridPoint> contactPoints(double robot_stiffness_N_per_m) {
  std::vector<LawGridPoint> points;
  for (const double band : kContactBands)
    for (const double profile : kContactProfiles)
      for (const double robot : {robot_stiffness_N_per_m, kNoLimit})
        for (const double speed : kContactSpeeds) points.push_back({band, profile, robot, speed});
  return points;
}

RunSetup contactSetup(const RunSetup& base, const LawGridPoint& point, const ContactTrial& trial) {
  RunSetup setup = lawGridSetup(base, point, GridLaw::kLimited);
  setup.controller.force_control->friction_coefficient = trial.bearable;
  for (ObstacleConfig& obstacle : setup.plant.obstacles)
    obstacle.friction_coefficient = trial.friction;
  SimulatedModuleConfig& module = setup.plant.modules[0];
  module.noise_N = trial.noise_N / module.channels.calibration.row(0).norm();
  return setup;
}

ContactFigures runContactGrid(const RunSetup& base, const std::vector<LawGridPoint>& points,
                              const ContactTrial& trial) {
  std::vector<RunSetup> setups;
  for (const LawGridPoint& point : points) setups.push_back(contactSetup(base, point, trial));
  std::vector<JudgedRun> runs(points.size());
  inParallel(runs.size(), [&](std::size_t i) { runs[i] = judgeRun(setups[i]); });
  ContactFigures figures;
  for (std::size_t i = 0; i < runs.size(); ++i) figures.add(setups[i], runs[i]);
  return figures;
}

void addContactRow(const ContactTrial& trial, std::size_t points, const ContactFigures& figures,
                   Table& table) {
  table.rows.push_back({trial.friction, trial.noise_N, trial.bearable, static_cast<double>(points),
                        static_cast<double>(figures.restless), static_cast<double>(figures.high),
                        figures.peak_to_scale, figures.rest_to_limit, 1e3 * figures.tcp_error_m});
}

std::vector<Goal> contactGoals(const Table& table) {
  const auto largest = [&table](const char* column, double mu, double mu_max) {
    return std::max(
        findNumber(table, column, {{"friction", mu}, {"noise_N", 0.0}, {"bears", mu_max}}),
        findNumber(table, column, {{"friction", mu}, {"noise_N", 0.05}, {"bears", mu_max}}));
  };
  return {
      {"friction 0.3, for which 0.5 is set: peak over the natural scale", 1.3,
       largest("largest_peak_to_scale", 0.3, 0.5)},
      {"the same: force at rest over the limit", 1.05, largest("largest_rest_to_limit", 0.3, 0.5)},
      {"friction 0.6, for which 0.8 is set: peak over the natural scale", 2.0,
       largest("largest_peak_to_scale", 0.6, 0.8)},
      {"the same: force at rest over the limit", 1.2, largest("largest_rest_to_limit", 0.6, 0.8)},
  };
}

}  // namespace

StudyResult studyContact(const BenchOptions& options) {
  const std::string path =
      options.scenes.empty() ? options.scenes_folder + kContactBase : options.scenes.front();
  const Scene scene = loadScene(path, {}, SceneUse::kSimulation);
  const RunSetup base{scene.controller, scene.plant, scene.period_s, scene.duration_s};
  std::vector<LawGridPoint> points = contactPoints(scene.plant.robot_stiffness_N_per_m);
  if (options.is_quick) {
    std::size_t i = 0;
    std::erase_if(points, [&](const LawGridPoint&) { return i++ % 12 > 0; });
  }
  Table table{"contact_friction",
              {"friction", "noise_N", "bears", "points", "limit_cycles", "peaks_above_1_3",
               "largest_peak_to_scale", "largest_rest_to_limit", "largest_tcp_error_mm"},
              {}};
  for (const double noise_N : kNoises_N) {
    for (const double friction : kFrictions) {
      for (const double bearable : kBearables) {
        const ContactTrial trial{friction, noise_N, bearable};
        addContactRow(trial, points.size(), runContactGrid(base, points, trial), table);
      }
    }
  }
  StudyResult result;
  result.title = "Contacts that rub";
  result.text =
      "null_limit on bands and profiles with friction, with no friction_coefficient set and with "
      "two: the true force's peak over what no law could avoid, and the force at rest over F_act + "
      "F_th. What the figures mean is in docs/approach_speed_limit.md.";
  result.goals = contactGoals(table);
  result.tables = {table};
  return result;
}

}  // namespace tactus
