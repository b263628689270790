#include "tactus/bench/drawn_environments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/bench/parallel.h"
#include "tactus/bench/random.h"
#include "tactus/control/controller.h"
#include "tactus/sim/obstacle_shape.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

constexpr double kPathSample_s = 0.02;
constexpr double kMinSpeedShare = 0.2;    ///< of the tool's, of the cover against the post
constexpr double kMaxInclination = 0.85;  ///< of the axis' z: no post meets a link that stands
constexpr double kDrawnRest_s = 20.0;
constexpr double kEnd_m = 0.1;  ///< how far beyond an end a post may come over it
constexpr double kHighPeak = 1.15, kWorsePeak = 1.02, kHighRest = 1.01;

void drawPath(BenchRandom& draw, RunSetup& setup) {
  ControllerConfig& controller = setup.controller;
  JointVector& q = controller.q_start;
  for (int i = 0; i < q.size(); ++i) {
    const double lower = controller.limits.lower[i], upper = controller.limits.upper[i];
    const double apart = 0.05 * std::min(upper - lower, 1e3);
    const double way = controller.chain.type(i) == JointType::kPrismatic ? 0.175 : 0.35;
    q[i] = std::clamp(q[i] + draw.uniform(-way, way), lower + apart, upper - apart);
  }
  const double direction = draw.uniform(0.0, 2.0 * std::numbers::pi);
  const double length_m = draw.uniform(0.2, 0.45);
  Waypoint& line = controller.task.trajectory.waypoints.front();
  line.displacement_m = Vector3(length_m * std::cos(direction), length_m * std::sin(direction),
                                draw.uniform(-0.1, 0.1));
  line.speed_m_per_s *= draw.logUniform(0.3, 5.0);
  setup.duration_s = 0.5 + line.displacement_m.norm() / line.speed_m_per_s + line.ramp_s;
}

/// Of the module, without obstacles.
std::vector<Pose> freePath(RunSetup setup) {
  setup.controller.force_control.reset();
  setup.plant.obstacles.clear();
  const Controller controller(setup.controller);
  SimulatedRobot robot(setup.controller, setup.plant, setup.period_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  ChainPose pose;
  std::vector<Pose> poses;
  const long stride = std::lround(kPathSample_s / setup.period_s);
  for (long k = 0; k < std::lround(setup.duration_s / setup.period_s); ++k) {
    robot.read(input);
    controller.update(input, setup.controller.gains, static_cast<double>(k) * setup.period_s,
                      setup.period_s, state, output);
    robot.write(output.velocity);
    if (k % stride > 0) continue;
    setup.controller.chain.computePose(input.q_measured, pose);
    poses.push_back(framePose(pose, setup.controller.tactile_modules.front().link));
  }
  return poses;
}

/// Before the cover at a moment of its path, if it moves sidewards there.
bool placePost(BenchRandom& draw, const RunSetup& setup, const std::vector<Pose>& path,
               double earliest, ObstacleConfig& post) {
  const double share = draw.uniform(earliest, 0.9);
  const double x_m = draw.uniform(0.08, 0.92) * setup.controller.tactile_modules.front().length_m;
  const auto k =
      std::min(path.size() - 2, static_cast<std::size_t>(share * static_cast<double>(path.size())));
  const Vector3 u = path[k].R_AB.col(0);
  if (std::abs(u.z()) > kMaxInclination) return false;
  const Vector3 side = Vector3(-u.y(), u.x(), 0.0).normalized();
  const Vector3 p_Base = path[k].p_AB + x_m * u;
  const Vector3 way = path[k + 1].p_AB + x_m * path[k + 1].R_AB.col(0) - p_Base;
  const double speed = side.dot(way) / kPathSample_s;
  const Waypoint& line = setup.controller.task.trajectory.waypoints.front();
  if (std::abs(speed) < kMinSpeedShare * line.speed_m_per_s) return false;
  const Vector3 p_BasePost =
      p_Base + std::copysign(setup.plant.modules[0].cover_radius_m, speed) * side;
  post.x_m = p_BasePost.x();
  post.y_m = p_BasePost.y();
  return true;
}

/// Returns whether the link meets the last of them on a free path.
bool drawPosts(BenchRandom& draw, RunSetup& setup) {
  const std::vector<Pose> path = freePath(setup);
  PlantConfig& plant = setup.plant;
  plant.obstacles.clear();
  plant.robot_stiffness_N_per_m =
      draw.uniform(0.0, 1.0) < 0.4 ? kNoLimit : draw.logUniform(2e3, 1e5);
  ObstacleConfig band, profile;
  band.stiffness_N_per_m = draw.logUniform(5.0, 600.0);
  if (draw.uniform(0.0, 1.0) < 0.7 && placePost(draw, setup, path, 0.1, band))
    plant.obstacles.push_back(band);
  profile.stiffness_N_per_m = draw.logUniform(1e3, 1e6);
  if (draw.uniform(0.0, 1.0) < 0.3)
    profile.foam = {{draw.logUniform(300.0, 3000.0), draw.uniform(2.0, 16.0)}};
  const bool is_met = placePost(draw, setup, path, 0.2, profile);
  plant.obstacles.push_back(profile);
  return is_met;
}

/// Whether posts come over the ends of the cover.
class EndWatch {
 public:
  explicit EndWatch(const RunSetup& setup)
      : chain_(setup.controller.chain),
        module_(setup.controller.tactile_modules.front()),
        radius_m_(setup.plant.modules[0].cover_radius_m) {
    for (const ObstacleConfig& obstacle : setup.plant.obstacles)
      posts_.push_back({ObstacleShape(obstacle), ObstacleShape(obstacle)});
  }

  bool isOut(const JointVector& q, bool is_start) {
    chain_.computePose(q, pose_);
    const Pose X = framePose(pose_, module_.link);
    const Vector3 u = X.R_AB.col(0);
    const CoverAxis cover{X.p_AB, u, module_.length_m, radius_m_};
    const CoverAxis longer{X.p_AB - kEnd_m * u, u, module_.length_m + 2.0 * kEnd_m, radius_m_};
    bool is_out = false;
    for (auto& [at_cover, at_longer] : posts_) {
      const bool touches = at_cover.meet(cover, Vector3::Zero()).depth_m > 0.0;
      const bool touches_longer = at_longer.meet(longer, Vector3::Zero()).depth_m > 0.0;
      is_out = is_out || (is_start ? touches_longer : touches_longer && !touches);
    }
    return is_out;
  }

 private:
  SerialChain chain_;
  TactileModuleConfig module_;
  double radius_m_;
  std::vector<std::pair<ObstacleShape, ObstacleShape>> posts_;
  ChainPose pose_;
};

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
    drawn.is_out = drawn.is_out || ends.isOut(q, t_s == 0.0);
  };
  drawn.run = judgeRun(watched);
  return drawn;
}

Table emptyDrawnTable() {
  return {"law_drawn",
          {"arm", "runs", "peaks_above_1_15", "largest_peak_to_scale", "limit_cycles",
           "rests_above_1_01", "largest_rest_to_limit", "estimation_hurts", "estimation_helps",
           "without_estimator_peaks_above_1_15", "without_estimator_limit_cycles"},
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
  double largest_rest = 0.0, assumed_high = 0, assumed_restless = 0;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    if (estimated[i].is_out || assumed[i].is_out) continue;
    const JudgedRun& run = estimated[i].run;
    const JudgedRun& other = assumed[i].run;
    const ForceGains& force = setups[i].controller.gains.force;
    const double limit_N = force.activation_force_N + force.contact_threshold_N;
    const double ratio = run.peak_true_force_N / naturalScale(setups[i], run);
    const double peak_N = run.peak_true_force_N, other_N = other.peak_true_force_N;
    runs += 1;
    high += ratio > kHighPeak;
    highest = std::max(highest, ratio);
    restless += run.isRestless();
    rests += !(run.peak_at_rest_N <= kHighRest * limit_N);
    largest_rest = std::max(largest_rest, run.peak_at_rest_N / limit_N);
    hurts += peak_N > kWorsePeak * std::max(other_N, limit_N);
    helps += other_N > kWorsePeak * std::max(peak_N, limit_N);
    assumed_high += other_N > kHighPeak * naturalScale(setups[i], other);
    assumed_restless += other.isRestless();
  }
  table.rows.push_back({arm, runs, high, highest, restless, rests, largest_rest, hurts, helps,
                        assumed_high, assumed_restless});
}

}  // namespace tactus
