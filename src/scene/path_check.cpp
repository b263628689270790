#include "tactus/scene/path_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/analysis/path_contacts.h"
#include "tactus/control/controller.h"
#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus {
namespace {

constexpr double kMaxLag = 1e-3;  ///< m or rad; discretisation alone stays far below
/// Behind the path's end: what leads the joints on in the null space may take the tool away.
constexpr double kRest_s = 10.0;

std::string singularStart(const ControllerConfig& config) {
  const double smallest = smallestSingularValueAtStart(config, config.weights);
  if (smallest >= WeightedPseudoinverse::kDampingThreshold) return "";
  return fmt::format(
      "singular start: smallest singular value {:.3g}, damped below {:g}, so that the tool lags "
      "behind; better another start, or fewer task.components",
      smallest, WeightedPseudoinverse::kDampingThreshold);
}

/// Why the tool lags: the joint that is nearest to its largest speed, if it is there.
std::string slowestJoint(const Scene& scene, const JointVector& velocity) {
  Eigen::Index joint = 0;
  const double share =
      (velocity.cwiseAbs().array() / scene.controller.limits.max_velocity.array()).maxCoeff(&joint);
  constexpr double kFull = 0.999;
  if (share < kFull)
    return fmt::format("limits of position or acceleration, {}or a singular pose, hold it back",
                       scene.controller.clearance ? "the clearance " : "");
  return fmt::format("joint {} is at its largest speed of {:g}", scene.joint_names[joint],
                     scene.controller.limits.max_velocity[joint]);
}

/// Half a turn ahead the way there is the other one.
std::string wayRound(const TaskConfig& task, const TaskGains& gains) {
  const bool turns = std::ranges::any_of(task.trajectory.waypoints, [](const Waypoint& waypoint) {
    return waypoint.rotation_vector_rad.norm() > 0.0;
  });
  if (!turns || gains.wait_beyond_rad < kNoLimit) return "";
  return "; a tool that falls behind by half a turn would turn back the other way, not with "
         "task.wait_beyond_rad";
}

/// Where the tool first lags behind its path, or how much of it was not followed.
std::string laggingPath(const Scene& scene) {
  const ControllerConfig config = undisturbed(scene.controller);
  const double end_s = Trajectory(config.task.trajectory, Pose{}).end_s();
  const double last_s = std::max(end_s, std::min(end_s + kRest_s, scene.duration_s));
  const auto cycles = std::llround(std::min(last_s / scene.period_s, kMaxFollowedCycles));
  const Controller controller(config);
  ControllerState state = controller.initialState();
  controller.begin(state);
  ControllerOutput output;
  for (long long cycle = 0; cycle < cycles; ++cycle) {
    const double t_s = static_cast<double>(cycle) * scene.period_s;
    controller.update(RobotInput{}, config.gains, t_s, scene.period_s, state, output);
    const double lag = output.error.norm();
    if (lag > kMaxLag)
      return fmt::format("{}: at {:.3f} s the tool lags by {:g} mm or mrad; {}{}",
                         t_s > end_s ? "end of the path not kept" : "path not followed", t_s,
                         1e3 * kMaxLag, slowestJoint(scene, output.velocity),
                         wayRound(config.task, scene.controller.gains.task));
  }
  const double followed_s = kMaxFollowedCycles * scene.period_s;
  if (end_s <= followed_s) return "";
  return fmt::format("only the first {:g} s of the path were followed, which ends at {:g} s",
                     followed_s, end_s);
}

std::string shortRun(const Scene& scene) {
  const double end_s = Trajectory(scene.controller.task.trajectory, Pose{}).end_s();
  if (!(scene.duration_s < end_s)) return "";
  return fmt::format("the simulation ends at {:g} s, its path at {:g} s", scene.duration_s, end_s);
}

std::string unfeltObstacles(const Scene& scene) {
  if (!scene.controller.tactile_modules.empty() || scene.plant.obstacles.empty()) return "";
  return "nothing feels the obstacles: there is no controller";
}

/// The first module whose simulated cover nobody takes out of its readings.
std::string uncompensatedCover(const Scene& scene) {
  const std::vector<TactileModuleConfig>& read = scene.controller.tactile_modules;
  for (std::size_t i = 0; i < read.size(); ++i) {
    const std::optional<CoverConfig>& cover = scene.plant.modules[i].cover;
    if (!cover || read[i].cover) continue;
    return fmt::format(
        "the cover of {:g} kg on {} is felt as a contact of up to {:.3g} N where it turns over; "
        "better a section cover of the tactile module in robot.yaml",
        cover->mass_kg, scene.module_links[i],
        2.0 * cover->mass_kg * scene.plant.gravity_Base.norm());
  }
  return "";
}

}  // namespace

std::vector<std::string> checkPath(const Scene& scene) {
  std::vector<std::string> warnings;
  for (const std::string& warning :
       {singularStart(scene.controller), laggingPath(scene), shortRun(scene),
        unfeltObstacles(scene), uncompensatedCover(scene)}) {
    if (!warning.empty()) warnings.push_back(warning);
  }
  return warnings;
}

double smallestSingularValueAtStart(const ControllerConfig& config, const JointVector& weights) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  TaskJacobian J;
  computeTipJacobian(config.chain, pose, framePosition(pose, config.chain.tip()),
                     config.task.components.data(), config.task.size, J);
  return smallestSingularValue(J, weights);
}

}  // namespace tactus
