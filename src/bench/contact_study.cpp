#include <algorithm>
#include <cmath>
#include <string>

#include "tactus/bench/arm_bases.h"
#include "tactus/bench/law_grid.h"
#include "tactus/bench/parallel.h"
#include "tactus/bench/random.h"
#include "tactus/bench/study.h"

namespace tactus {
namespace {

constexpr const char* kContactBase = "/scenario2_estimated.yaml";
constexpr std::array kContactBands = {0.0, 30.0, 200.0};           // N/m
constexpr std::array kContactProfiles = {3e3, 17e3, 1e5, 1e6};     // N/m
constexpr std::array kContactSpeeds = {1.0, 2.4};                  // of the base's
constexpr std::array kFrictions = {0.0, 0.1, 0.2, 0.3, 0.5, 0.6};  // mu
constexpr std::array kBearables = {0.0, 0.5, 0.8};                 // mu_max
constexpr std::array kNoises_N = {0.0, 0.05};
constexpr std::array kJudgedFrictions = {0.3, 0.6};
constexpr std::array kBesideMomentX = {0.0, 0.5};  // mu_max
/// Of the row of M_x where the base's module has none, m: with cells that are canted. Noise of
/// 0.05 N is of 2.1 mNm then.
constexpr double kMomentX_m = 0.03;
constexpr int kDrawn = 48;
constexpr std::uint64_t kDrawnSeed = 20'261'123;

struct ContactTrial {
  std::size_t arm = 0;  ///< of kArms
  double friction = 0.0;
  double noise_N = 0.0;
  double bearable = 0.0;
  bool has_moment_x = false;  ///< the module tells M_x
};

/// Also where y is NaN.
double larger(double x, double y) { return y <= x ? x : y; }

struct ContactFigures {
  int restless = 0;
  int faults = 0;
  int high = 0;  ///< peaks above kMaxRatio
  double peak_to_scale = 0.0, rest_to_limit = 0.0;
  double tcp_error_m = 0.0;
  static constexpr double kMaxRatio = 1.3;

  void add(const RunSetup& setup, const JudgedRun& run) {
    const ForceGains& force = setup.controller.gains.force;
    const double limit_N = force.activation_force_N + force.contact_threshold_N;
    const double ratio = run.peak_true_force_N / naturalScale(setup, run);
    restless += run.isRestless() ? 1 : 0;
    faults += run.fault != Fault::kNone ? 1 : 0;
    high += ratio > kMaxRatio ? 1 : 0;
    peak_to_scale = larger(peak_to_scale, ratio);
    rest_to_limit = larger(rest_to_limit, run.peak_at_rest_N / limit_N);
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

/// Where nobody has looked when the law was made.
std::vector<LawGridPoint> drawnPoints(double robot_stiffness_N_per_m) {
  BenchRandom random(kDrawnSeed);
  std::vector<LawGridPoint> points;
  for (int i = 0; i < kDrawn; ++i) {
    const double band = i % 3 == 0 ? 0.0 : random.logUniform(10.0, 600.0);
    const double profile = random.logUniform(1e3, 1e6);
    const double robot = i % 2 == 0 ? kNoLimit : robot_stiffness_N_per_m;
    points.push_back({band, profile, robot, random.uniform(0.5, 3.0)});
  }
  return points;
}

void tellMomentX(RunSetup& setup) {
  setup.controller.tactile_modules.front().feels_moment_x = true;
  std::optional<TactileChannelRow>& row = setup.plant.modules[0].channels.moment_x;
  if (!row) row = TactileChannelRow::Constant(kMomentX_m);
}

RunSetup contactSetup(const ArmBases& bases, const LawGridPoint& point, const ContactTrial& trial) {
  RunSetup setup = lawGridSetup(bases[trial.arm], point, GridLaw::kLimited);
  if (trial.arm > 0) {  // which has its own
    setup.plant.robot_stiffness_N_per_m = bases[trial.arm].plant.robot_stiffness_N_per_m;
    setup.arm_stiffness_N_per_m = bases.front().plant.robot_stiffness_N_per_m;
  }
  setup.controller.force_control->friction_coefficient = trial.bearable;
  for (ObstacleConfig& obstacle : setup.plant.obstacles)
    obstacle.friction_coefficient = trial.friction;
  SimulatedModuleConfig& module = setup.plant.modules[0];
  module.noise_N = trial.noise_N / module.channels.calibration.row(0).norm();
  if (trial.has_moment_x) tellMomentX(setup);
  return setup;
}

ContactFigures runContacts(const ArmBases& bases, const std::vector<LawGridPoint>& points,
                           const ContactTrial& trial) {
  std::vector<RunSetup> setups;
  for (const LawGridPoint& point : points) setups.push_back(contactSetup(bases, point, trial));
  std::vector<JudgedRun> runs(points.size());
  inParallel(runs.size(), [&](std::size_t i) { runs[i] = judgeRun(setups[i]); });
  ContactFigures figures;
  for (std::size_t i = 0; i < runs.size(); ++i) figures.add(setups[i], runs[i]);
  return figures;
}

void addContactRow(const ArmBases& bases, const std::vector<LawGridPoint>& points,
                   const ContactTrial& trial, Table& table) {
  const ContactFigures figures = runContacts(bases, points, trial);
  table.rows.push_back({static_cast<double>(trial.arm), trial.friction, trial.noise_N,
                        trial.bearable, static_cast<double>(points.size()),
                        static_cast<double>(figures.faults), static_cast<double>(figures.restless),
                        static_cast<double>(figures.high), figures.peak_to_scale,
                        figures.rest_to_limit, 1e3 * figures.tcp_error_m});
}

Table contactTable(const std::string& name) {
  return {
      name,
      {"arm", "friction", "noise_N", "bears", "points", "faults", "limit_cycles", "peaks_above_1_3",
       "largest_peak_to_scale", "largest_rest_to_limit", "largest_tcp_error_mm"},
      {}};
}

/// What is to be set for it: more than there is, for lag, mass and gears tilt the force, too.
double bearableFor(double friction) { return friction > 0.3 ? 0.8 : 0.5; }

/// With what is to be set, and, as they take their time, only where it counts.
void addJudgedRows(const ArmBases& bases, std::size_t arm, const std::vector<LawGridPoint>& points,
                   Table& table) {
  for (const double noise_N : kNoises_N)
    for (const double friction : kJudgedFrictions)
      addContactRow(bases, points, {arm, friction, noise_N, bearableFor(friction)}, table);
}

/// For arms with mass, whose stiffness is their own.
std::vector<LawGridPoint> massivePoints(std::vector<LawGridPoint> points) {
  std::erase_if(points,
                [](const LawGridPoint& x) { return x.robot_stiffness_N_per_m != kNoLimit; });
  return points;
}

Table gridTable(const ArmBases& bases, const std::vector<LawGridPoint>& points) {
  Table table = contactTable("contact_friction");
  for (const double noise_N : kNoises_N)
    for (const double friction : kFrictions)
      for (const double bearable : kBearables)
        addContactRow(bases, points, {0, friction, noise_N, bearable}, table);
  for (std::size_t arm = 1; arm < bases.size(); ++arm)
    addJudgedRows(bases, arm, massivePoints(points), table);
  return table;
}

Table drawnTable(const ArmBases& bases, const std::vector<LawGridPoint>& points) {
  Table table = contactTable("contact_drawn");
  for (std::size_t arm = 0; arm < bases.size(); ++arm)
    addJudgedRows(bases, arm, arm > 0 ? massivePoints(points) : points, table);
  return table;
}

/// Of a module that tells M_x, alone and with a friction_coefficient beside.
Table momentTable(const ArmBases& bases, const std::vector<LawGridPoint>& points) {
  Table table = contactTable("contact_moment_x");
  for (std::size_t arm = 0; arm < bases.size(); arm += 2) {  // rigid gears are in between
    for (const double noise_N : kNoises_N)
      for (const double friction : kJudgedFrictions)
        for (const double bearable : kBesideMomentX)
          addContactRow(bases, arm > 0 ? massivePoints(points) : points,
                        {arm, friction, noise_N, bearable, true}, table);
  }
  return table;
}

/// With and without noise, on the grid and where points were drawn.
double largest(const std::vector<Table>& tables, const char* column, double arm, double friction) {
  double found = 0.0;
  for (const Table& table : tables)
    for (const double noise_N : kNoises_N)
      found = larger(found, findNumber(table, column,
                                       {{"arm", arm},
                                        {"friction", friction},
                                        {"noise_N", noise_N},
                                        {"bears", bearableFor(friction)}}));
  return found;
}

std::vector<Goal> contactGoals(const ArmBases& bases, const std::vector<Table>& tables) {
  std::vector<Goal> goals;
  for (std::size_t arm = 0; arm < bases.size(); ++arm) {
    const std::string where = std::string(kArms[arm]) + ", friction ";
    const auto number = static_cast<double>(arm);
    goals.push_back({where + "0.3, for which 0.5 is set: peak over the natural scale", 1.3,
                     largest(tables, "largest_peak_to_scale", number, 0.3)});
    goals.push_back({where + "0.3: force at rest over the limit", 1.05,
                     largest(tables, "largest_rest_to_limit", number, 0.3)});
    goals.push_back({where + "0.6, for which 0.8 is set: peak over the natural scale", 2.0,
                     largest(tables, "largest_peak_to_scale", number, 0.6)});
    goals.push_back({where + "0.6: force at rest over the limit", 1.2,
                     largest(tables, "largest_rest_to_limit", number, 0.6)});
    goals.push_back({where + "0.3: runs that do not come to rest, of each row", 0.0,
                     largest(tables, "limit_cycles", number, 0.3)});
    goals.push_back(
        {where + "0.3 and 0.6: runs that end in a fault, of each row", 0.0,
         std::max(largest(tables, "faults", number, 0.3), largest(tables, "faults", number, 0.6))});
  }
  return goals;
}

/// Of a module that tells M_x, with this set beside.
void addMomentGoals(const Table& table, std::size_t arm, double bearable, double noise_N,
                    std::vector<Goal>& goals) {
  const auto find = [&](const char* column, double friction) {
    return findNumber(table, column,
                      {{"arm", static_cast<double>(arm)},
                       {"friction", friction},
                       {"noise_N", noise_N},
                       {"bears", bearable}});
  };
  const std::string where = std::string("with M_x, ") + kArms[arm] +
                            (noise_N > 0.0 ? ", noise" : ", no noise") +
                            (bearable > 0.0 ? ", 0.5 set" : ", nothing set") + ", friction ";
  goals.push_back(
      {where + "0.3: peak over the natural scale", 1.3, find("largest_peak_to_scale", 0.3)});
  goals.push_back(
      {where + "0.3: force at rest over the limit", 1.1, find("largest_rest_to_limit", 0.3)});
  goals.push_back({where + "0.3: runs that do not come to rest", 0.0, find("limit_cycles", 0.3)});
  goals.push_back(
      {where + "0.6: peak over the natural scale", 2.0, find("largest_peak_to_scale", 0.6)});
}

/// Alone without noise; with noise a stiff contact wants the cone beside it.
void addMomentGoals(const Table& table, const ArmBases& bases, std::vector<Goal>& goals) {
  for (std::size_t arm = 0; arm < bases.size(); arm += 2) {
    addMomentGoals(table, arm, 0.0, kNoises_N[0], goals);
    addMomentGoals(table, arm, kBesideMomentX[1], kNoises_N[1], goals);
  }
}

}  // namespace

StudyResult studyContact(const BenchOptions& options) {
  const ArmBases bases = armBases(options.scenes.empty() ? options.scenes_folder + kContactBase
                                                         : options.scenes.front());
  const double robot_N_per_m = bases.front().plant.robot_stiffness_N_per_m;
  std::vector<LawGridPoint> grid = contactPoints(robot_N_per_m);
  std::vector<LawGridPoint> drawn = drawnPoints(robot_N_per_m);
  if (options.is_quick) {
    std::size_t i = 0;
    std::erase_if(grid, [&](const LawGridPoint&) { return i++ % 11 > 0; });
    drawn.resize(2);
  }
  StudyResult result;
  result.title = "Contacts that rub";
  result.text =
      "null_limit on bands and profiles with friction, with no friction_coefficient set and with "
      "two: the true force's peak over what no law could avoid, and the force at rest over F_act + "
      "F_th; with an arm without mass (0), with masses and rigid gears (1), with flexible ones "
      "(2). "
      "At rest means the largest true force of the last 2 s. First a grid, then points that were "
      "drawn, then the grid with a module that tells M_x. What the figures mean is in "
      "docs/approach_speed_limit.md.";
  result.tables = {gridTable(bases, grid), drawnTable(bases, drawn)};
  result.goals = contactGoals(bases, result.tables);
  result.tables.push_back(momentTable(bases, grid));
  addMomentGoals(result.tables.back(), bases, result.goals);
  return result;
}

}  // namespace tactus
