#include "tactus/bench/drawn_environments.h"

#include <algorithm>

#include "tactus/bench/parallel.h"
#include "tactus/bench/post_placing.h"

namespace tactus {
namespace {

constexpr double kDrawnRest_s = 20.0;
constexpr double kWorsePeak = 1.02, kHighRest = 1.01;

/// Returns whether the link meets the last of them on a free path.
bool drawPosts(BenchRandom& draw, RunSetup& setup) {
  const std::vector<Pose> path = freePaths(setup).front();
  const auto place = [&](double earliest, ObstacleConfig& post) {
    PostPlace at;
    at.path_share = draw.uniform(earliest, 0.9);
    at.length_share = draw.uniform(0.08, 0.92);
    return placePost(setup, path, 0, at, post);
  };
  PlantConfig& plant = setup.plant;
  plant.obstacles.clear();
  plant.robot_stiffness_N_per_m =
      draw.uniform(0.0, 1.0) < 0.4 ? kNoLimit : draw.logUniform(2e3, 1e5);
  ObstacleConfig band, profile;
  band.stiffness_N_per_m = draw.logUniform(5.0, 600.0);
  if (draw.uniform(0.0, 1.0) < 0.7 && place(0.1, band)) plant.obstacles.push_back(band);
  profile.stiffness_N_per_m = draw.logUniform(1e3, 1e6);
  if (draw.uniform(0.0, 1.0) < 0.3)
    profile.foam = {{draw.logUniform(300.0, 3000.0), draw.uniform(2.0, 16.0)}};
  const bool is_met = place(0.2, profile);
  plant.obstacles.push_back(profile);
  return is_met;
}

}  // namespace

std::vector<RunSetup> drawEnvironments(const RunSetup& base, std::uint64_t seed, int count) {
  BenchRandom draw(seed);
  std::vector<RunSetup> setups;
  for (int i = 0; i < count; ++i) {
    RunSetup setup = base;
    setup.controller.force_control->variant = Variant::kNullLimit;
    setup.controller.force_control->has_estimator = true;
    setup.controller.tactile_modules.front().max_force_N = kNoLimit;
    setup.plant.modules[0].quantised = false;
    drawPath(draw, setup);
    const bool is_met = drawPosts(draw, setup);
    setup.duration_s += kDrawnRest_s;
    if (is_met) setups.push_back(std::move(setup));
  }
  return setups;
}

DrawnRun runDrawn(const RunSetup& setup) {
  DrawnRun drawn;
  EndWatch ends(setup);
  RunSetup watched = setup;
  watched.watch = [&](const JointVector& q, double t_s) {
    drawn.is_out = drawn.is_out || ends.isOut(q, t_s);
  };
  drawn.run = judgeRun(watched);
  return drawn;
}

Table emptyDrawnTable() {
  return {
      "law_drawn",
      {"arm", "runs", "peaks_above_1_15", "largest_peak_to_scale", "limit_cycles",
       "rests_above_1_01", "largest_rest_to_limit", "estimation_hurts", "estimation_helps",
       "without_estimator_peaks_above_1_15", "without_estimator_limit_cycles", "faults", "left_out",
       "left_out_peaks_above_1_15", "left_out_largest_peak_to_scale", "left_out_limit_cycles"},
      {}};
}

void addDrawnRow(const std::string& arm, const std::vector<RunSetup>& setups, Table& table) {
  std::vector<DrawnRun> estimated(setups.size()), assumed(setups.size());
  inParallel(setups.size(), [&](std::size_t i) {
    estimated[i] = runDrawn(setups[i]);
    RunSetup setup = setups[i];
    setup.controller.force_control->has_estimator = false;
    assumed[i] = runDrawn(setup);
  });
  double runs = 0, high = 0, restless = 0, rests = 0, hurts = 0, helps = 0, highest = 0.0;
  double largest_rest = 0.0, assumed_high = 0, assumed_restless = 0, faults = 0;
  double out = 0, out_high = 0, out_highest = 0.0, out_restless = 0;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const JudgedRun& run = estimated[i].run;
    const JudgedRun& other = assumed[i].run;
    const ForceGains& force = setups[i].controller.gains.force;
    const double limit_N = force.activation_force_N + force.contact_threshold_N;
    const double ratio = run.peak_true_force_N / naturalScale(setups[i], run);
    const double peak_N = run.peak_true_force_N, other_N = other.peak_true_force_N;
    if (estimated[i].is_out || assumed[i].is_out) {  // no module felt all of it, but it is told
      out += 1;
      out_high += !(ratio <= JudgedRun::kHighPeak);
      out_highest = std::max(out_highest, ratio);
      out_restless += run.isRestless();
      continue;
    }
    runs += 1;
    faults += run.fault != Fault::kNone || other.fault != Fault::kNone;
    high += !(ratio <= JudgedRun::kHighPeak);
    highest = std::max(highest, ratio);
    restless += run.isRestless();
    rests += !(run.peak_at_rest_N <= kHighRest * limit_N);
    largest_rest = std::max(largest_rest, run.peak_at_rest_N / limit_N);
    hurts += peak_N > kWorsePeak * std::max(other_N, limit_N);
    helps += other_N > kWorsePeak * std::max(peak_N, limit_N);
    assumed_high += !(other_N <= JudgedRun::kHighPeak * naturalScale(setups[i], other));
    assumed_restless += other.isRestless();
  }
  table.rows.push_back({arm, runs, high, highest, restless, rests, largest_rest, hurts, helps,
                        assumed_high, assumed_restless, faults, out, out_high, out_highest,
                        out_restless});
}

}  // namespace tactus
