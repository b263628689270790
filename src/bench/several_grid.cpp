#include "tactus/bench/several_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tactus/bench/post_placing.h"
#include "tactus/bench/random.h"

namespace tactus {
namespace {

constexpr double kSeveralRest_s = 20.0;
constexpr double kMinSideSpeedShare = 0.05;  ///< links near the base hardly move
constexpr int kDrawsEachPath = 20;
constexpr double kSoft_N_per_m = 7e3;  ///< what an obstacle may have that comes
constexpr double kSlow_m_per_s = 5e-3;

int drawInteger(BenchRandom& draw, int below) {
  return std::min(below - 1, static_cast<int>(draw.uniform(0.0, below)));
}

/// When a link reaches this share of the free path.
double timeAt_s(const RunSetup& setup, double path_share) {
  return path_share * (setup.duration_s - kSeveralRest_s);
}

void letMove(BenchRandom& draw, const RunSetup& setup, double path_share, ObstacleConfig& post) {
  const double way_m = draw.uniform(0.01, 0.03);
  const double direction = draw.uniform(0.0, 6.283185307);
  post.swing = {way_m * std::cos(direction), way_m * std::sin(direction),
                kSlow_m_per_s / (6.283185307 * way_m)};
  post.appears_s = timeAt_s(setup, path_share) * 0.5;
}

/// Where the second and third posts stand, by the kind.
PostPlace placeOf(BenchRandom& draw, SeveralKind kind, double share) {
  PostPlace place;
  place.path_share = share;
  place.length_share = draw.uniform(0.1, 0.9);
  if (kind == SeveralKind::kSequence)
    place.path_share = std::min(0.95, share + draw.uniform(0.05, 0.4));
  place.min_speed_share = kMinSideSpeedShare;
  place.is_behind = kind == SeveralKind::kOpposite || kind == SeveralKind::kSqueezed;
  if (kind == SeveralKind::kOpposite) place.gap_m = draw.uniform(0.01, 0.06);
  if (kind == SeveralKind::kSqueezed) place.gap_m = draw.uniform(0.002, 0.01);
  return place;
}

/// Which modules have posts, each once, in the order of the draw. Both sides of one: same_module.h.
std::vector<std::size_t> drawModules(BenchRandom& draw, int modules) {
  std::vector<std::size_t> order(static_cast<std::size_t>(modules));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i],
              order[static_cast<std::size_t>(drawInteger(draw, static_cast<int>(i) + 1))]);
  const int posts = draw.uniform(0.0, 1.0) < 0.7 ? 2 : std::min(3, modules);
  order.resize(static_cast<std::size_t>(std::min(posts, modules)));
  return order;
}

bool placePosts(BenchRandom& draw, const ModulePaths& paths, SeveralCase& drawn) {
  RunSetup& setup = drawn.setup;
  const std::vector<std::size_t> modules = drawModules(draw, static_cast<int>(paths.size()));
  drawn.modules = static_cast<int>(modules.size());
  const double share = draw.uniform(0.15, 0.7);
  setup.plant.obstacles.clear();
  for (std::size_t i = 0; i < modules.size(); ++i) {
    ObstacleConfig post;
    const bool moves = drawn.kind == SeveralKind::kMoving && i > 0;
    post.stiffness_N_per_m = draw.logUniform(100.0, moves ? kSoft_N_per_m : 1e6);
    const PostPlace place = placeOf(draw, i == 0 ? SeveralKind::kAtOnce : drawn.kind, share);
    if (!placePost(setup, paths[modules[i]], modules[i], place, post)) return false;
    if (drawn.kind == SeveralKind::kVanishing && i == 0)
      post.vanishes_s = timeAt_s(setup, share) + draw.uniform(1.0, 8.0);
    if (moves) letMove(draw, setup, share, post);
    setup.plant.obstacles.push_back(post);
  }
  return !EndWatch(setup).isOut(setup.controller.q_start, 0.0);
}

bool drawSeveralPosts(BenchRandom& draw, SeveralCase& drawn) {
  RunSetup& setup = drawn.setup;
  const ModulePaths paths = freePaths(setup);
  setup.duration_s += kSeveralRest_s;
  setup.plant.robot_stiffness_N_per_m =
      draw.uniform(0.0, 1.0) < 0.4 ? kNoLimit : draw.logUniform(2e3, 1e5);
  for (int i = 0; i < kDrawsEachPath; ++i)
    if (placePosts(draw, paths, drawn)) return true;
  return false;
}

struct Figures {
  double runs = 0, faults = 0, both = 0, high = 0, highest = 0.0, restless = 0, most_restless = 0.0,
         rests = 0, largest_rest = 0.0, largest_tcp = 0.0, steps = 0.0, step = 0.0, intrusion = 0.0;
  double out = 0, out_high = 0, out_highest = 0.0, out_restless = 0;

  void add(const SeveralCase& drawn, const SeveralRun& run) {
    const bool is_one_module = drawn.kind >= SeveralKind::kSameSide;
    const double peak = is_one_module ? run.contact_peak_to_scale : run.largest_peak_to_scale;
    if (run.is_out) return addOut(run, peak);
    runs += 1;
    faults += run.fault != Fault::kNone;
    both += (is_one_module ? run.touched_posts : run.touched_modules) > 1;
    high += !(peak <= JudgedRun::kHighPeak);
    highest = std::max(highest, peak);
    restless += !(run.restlessness_N <= JudgedRun::kMaxRestlessness_N);
    most_restless = std::max(most_restless, run.restlessness_N);
    rests += !(run.peak_at_rest_N <= 1.02 * run.limit_N);
    largest_rest = std::max(largest_rest, run.peak_at_rest_N / run.limit_N);
    largest_tcp = std::max(largest_tcp, run.tcp_error_final_m);
    steps += run.step_between_samples > 0.02;
    step = std::max(step, run.step_between_samples);
    intrusion = std::max(intrusion, -run.clearance_left_m);
  }

  /// What no module felt says nothing of the law, but is told.
  void addOut(const SeveralRun& run, double peak) {
    out += 1;
    out_high += !(peak <= JudgedRun::kHighPeak);
    out_highest = std::max(out_highest, peak);
    out_restless += !(run.restlessness_N <= JudgedRun::kMaxRestlessness_N);
  }
};

void addRow(const std::string& trial, const std::string& kind, const Figures& f, Table& table) {
  if (f.runs + f.out == 0.0) return;
  table.rows.push_back({trial, kind, f.runs, f.both, f.high, f.highest, f.restless, f.most_restless,
                        f.rests, f.largest_rest, f.largest_tcp, f.steps, f.step, f.intrusion,
                        f.faults, f.out, f.out_high, f.out_highest, f.out_restless});
}

}  // namespace

const char* severalKindName(SeveralKind kind) {
  static constexpr const char* kNames[kSeveralKinds] = {"at_once",   "sequence",  "opposite",
                                                        "squeezed",  "vanishing", "moving",
                                                        "same_side", "across",    "both_sides"};
  return kNames[static_cast<int>(kind)];
}

RunSetup withoutLimits(RunSetup base) {
  // Limits would spread a step over several cycles.
  base.controller.limits.max_acceleration.setConstant(kNoLimit);
  for (TactileModuleConfig& module : base.controller.tactile_modules) module.max_force_N = kNoLimit;
  for (SimulatedModuleConfig& module : base.plant.modules) module.quantised = false;
  return base;
}

std::vector<SeveralCase> drawSeveral(const RunSetup& base, std::uint64_t seed, int count) {
  BenchRandom draw(seed);
  std::vector<SeveralCase> cases;
  for (int i = 0; i < count; ++i) {
    SeveralCase drawn{static_cast<SeveralKind>(i % kDrawnKinds),
                      static_cast<Surroundings>(i / kDrawnKinds % kSurroundings), 0,
                      withoutLimits(base)};
    // A way to stop has to know them.
    if (base.controller.clearance && drawn.surroundings >= Surroundings::kBodies)
      drawn.setup.controller.limits.max_acceleration = base.controller.limits.max_acceleration;
    drawPath(draw, drawn.setup);
    if (surround(draw, drawn.surroundings, drawn.setup) && drawSeveralPosts(draw, drawn))
      cases.push_back(std::move(drawn));
  }
  return cases;
}

Table emptySeveralTable(const std::string& name) {
  return {name,
          {"trial", "kind", "runs", "with_several_contacts", "peaks_above_1_15",
           "largest_peak_to_scale", "restless", "largest_restlessness_N", "rests_above_1_02",
           "largest_rest_to_limit", "largest_tcp_error_m", "steps_above_0_02",
           "largest_step_between_samples", "largest_intrusion_m", "faults", "left_out",
           "left_out_peaks_above_1_15", "left_out_largest_peak_to_scale", "left_out_restless"},
          {}};
}

void addSeveralRows(const std::string& trial, const std::vector<SeveralCase>& cases,
                    const std::vector<SeveralRun>& runs, Table& table) {
  Figures all;
  std::array<Figures, kSeveralKinds> of_kind;
  std::array<Figures, kSurroundings> of_surroundings;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const SeveralCase& drawn = cases[i];
    of_kind[static_cast<std::size_t>(drawn.kind)].add(drawn, runs[i]);
    if (drawn.kind != SeveralKind::kMoving)
      of_surroundings[static_cast<std::size_t>(drawn.surroundings)].add(drawn, runs[i]);
    all.add(drawn, runs[i]);
  }
  for (std::size_t i = 0; i < of_kind.size(); ++i)
    addRow(trial, severalKindName(static_cast<SeveralKind>(i)), of_kind[i], table);
  for (std::size_t i = 0; i < of_surroundings.size(); ++i)
    addRow(trial, surroundingsName(static_cast<Surroundings>(i)), of_surroundings[i], table);
  addRow(trial, "all", all, table);
}

}  // namespace tactus
