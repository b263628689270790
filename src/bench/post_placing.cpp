#include "tactus/bench/post_placing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

constexpr double kPathSample_s = 0.02;
constexpr double kMaxInclination = 0.85;  ///< of the axis' z: no post meets a link that stands
constexpr double kEnd_m = 0.1;            ///< how far beyond an end a post may come over it

}  // namespace

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

ModulePaths freePaths(RunSetup setup) {
  setup.controller.force_control.reset();
  setup.plant.obstacles.clear();
  const Controller controller(setup.controller);
  SimulatedRobot robot(setup.controller, setup.plant, setup.period_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  ChainPose pose;
  const std::vector<TactileModuleConfig>& modules = setup.controller.tactile_modules;
  ModulePaths paths(modules.size());
  const long stride = std::lround(kPathSample_s / setup.period_s);
  for (long k = 0; k < std::lround(setup.duration_s / setup.period_s); ++k) {
    robot.read(input);
    controller.update(input, setup.controller.gains, static_cast<double>(k) * setup.period_s,
                      setup.period_s, state, output);
    robot.write(output.velocity);
    if (k % stride > 0) continue;
    setup.controller.chain.computePose(input.q_measured, pose);
    for (std::size_t i = 0; i < modules.size(); ++i)
      paths[i].push_back(framePose(pose, modules[i].link));
  }
  return paths;
}

bool placePost(const RunSetup& setup, const std::vector<Pose>& path, std::size_t module,
               const PostPlace& place, ObstacleConfig& post) {
  const double share = place.path_share;
  const double x_m = place.length_share * setup.controller.tactile_modules[module].length_m;
  const auto k =
      std::min(path.size() - 2, static_cast<std::size_t>(share * static_cast<double>(path.size())));
  const Vector3 u = path[k].R_AB.col(0);
  if (std::abs(u.z()) > kMaxInclination) return false;
  const Vector3 side = Vector3(-u.y(), u.x(), 0.0).normalized();
  const Vector3 p_Base = path[k].p_AB + x_m * u;
  const Vector3 way = path[k + 1].p_AB + x_m * path[k + 1].R_AB.col(0) - p_Base;
  const double speed = side.dot(way) / kPathSample_s;
  const Waypoint& line = setup.controller.task.trajectory.waypoints.front();
  if (std::abs(speed) < place.min_speed_share * line.speed_m_per_s) return false;
  const Vector3 p_BasePost =
      p_Base + std::copysign(setup.plant.modules[module].cover_radius_m + place.gap_m,
                             place.is_behind ? -speed : speed) *
                   side;
  post.x_m = p_BasePost.x();
  post.y_m = p_BasePost.y();
  return true;
}

EndWatch::EndWatch(const RunSetup& setup)
    : chain_(setup.controller.chain), modules_(setup.controller.tactile_modules) {
  for (std::size_t i = 0; i < modules_.size(); ++i)
    radii_m_.push_back(setup.plant.modules[i].cover_radius_m);
  for (ObstacleConfig post : setup.plant.obstacles) {
    post.stiffness_N_per_m = 1.0;
    post.foam.clear();
    for (std::size_t i = 0; i < modules_.size(); ++i)
      posts_.push_back({i, Obstacle(post, kNoLimit), Obstacle(post, kNoLimit)});
  }
}

bool EndWatch::isOut(const JointVector& q, double t_s) {
  chain_.computePose(q, pose_);
  bool is_out = false;
  for (Post& post : posts_) {
    const Pose X = framePose(pose_, modules_[post.module].link);
    const Vector3 u = X.R_AB.col(0);
    const double length_m = modules_[post.module].length_m;
    const double radius_m = radii_m_[post.module];
    const CoverAxis cover{X.p_AB, u, length_m, radius_m};
    const CoverAxis longer{X.p_AB - kEnd_m * u, u, length_m + 2.0 * kEnd_m, radius_m};
    const bool touches = post.at_cover.touch(cover, t_s).force_N > 0.0;
    const bool touches_longer = post.at_longer.touch(longer, t_s).force_N > 0.0;
    is_out |= t_s == 0.0 ? touches_longer
                         : touches_longer && post.touched_longer && touches != post.touched;
    post.touched = touches;
    post.touched_longer = touches_longer;
  }
  return is_out;
}

}  // namespace tactus
