#include "tactus/bench/clutter_grid.h"

#include <cmath>

#include "tactus/bench/random.h"
#include "tactus/math/serial_chain.h"

namespace tactus {
namespace {

constexpr double kClutterFrom_m = 0.2, kClutterTo_m = 0.6, kClutterSide_m = 0.3;
constexpr double kPostRadius_m = 0.01;
constexpr double kSoftPost_N_per_m = 100.0, kHardPost_N_per_m = 1000.0, kSlide_N = 2.0;
constexpr double kClutterRest_s = 8.0;  ///< after the path, to get through or come to rest

Vector3 drawPlace(BenchRandom& draw) {
  const double x_m = draw.uniform(kClutterFrom_m, kClutterTo_m);
  return {x_m, draw.uniform(-kClutterSide_m, kClutterSide_m), 0.0};
}

Vector3 drawGoal(BenchRandom& draw) {
  const double r_m = draw.uniform(0.5, 0.7), angle = draw.uniform(-0.5236, 0.5236);
  return {r_m * std::cos(angle), r_m * std::sin(angle), 0.0};
}

Vector3 tipAt(const ControllerConfig& controller) {
  ChainPose pose;
  controller.chain.computePose(controller.q_start, pose);
  return framePosition(pose, controller.chain.tip());
}

bool isFree(const Vector3& place, const std::vector<Vector3>& others, double apart_m) {
  for (const Vector3& other : others)
    if ((place - other).norm() < apart_m) return false;
  return true;
}

ObstacleConfig postAt(const Vector3& place, double height_m, ClutterKind kind) {
  constexpr double kHalf_m = 0.3;
  ObstacleConfig post;
  post.post = PostConfig{place + (height_m - kHalf_m) * Vector3::UnitZ(), Vector3::UnitZ(),
                         2.0 * kHalf_m, kPostRadius_m};
  post.stiffness_N_per_m = kind == ClutterKind::kSoft ? kSoftPost_N_per_m : kHardPost_N_per_m;
  if (kind == ClutterKind::kSliding) post.slide_force_N = kSlide_N;
  return post;
}

void setGoal(const Vector3& goal, RunSetup& setup) {
  Waypoint& line = setup.controller.task.trajectory.waypoints.front();
  line.displacement_m = goal - tipAt(setup.controller);
  line.displacement_m.z() = 0.0;
  setup.duration_s = setup.controller.task.trajectory.start_s +
                     line.displacement_m.norm() / line.speed_m_per_s + line.ramp_s + kClutterRest_s;
}

/// The covers of all modules but those of a joint, as parts of links that nothing feels; these
/// become one.
void keepOneModule(int joint, RunSetup& setup) {
  std::vector<TactileModuleConfig> felt;
  SimulatedModuleConfig simulated;
  for (std::size_t i = 0; i < setup.controller.tactile_modules.size(); ++i) {
    const TactileModuleConfig& module = setup.controller.tactile_modules[i];
    const bool is_along = std::abs(module.link.X_JointFrame.R_AB(2, 0)) < 0.5;
    if (module.link.joint == joint && is_along) {
      if (felt.empty()) simulated = setup.plant.modules[i];
      if (felt.empty())
        felt.push_back(module);
      else
        felt.front().length_m += module.length_m;
      continue;
    }
    setup.plant.capsules.push_back({module.link, Vector3::Zero(),
                                    module.length_m * Vector3::UnitX(),
                                    setup.plant.modules[i].cover_radius_m});
  }
  setup.controller.tactile_modules = felt;
  setup.plant.modules = {simulated};
}

}  // namespace

const char* clutterKindName(ClutterKind kind) {
  static constexpr const char* kNames[kClutterKinds] = {"soft", "sliding", "hard"};
  return kNames[static_cast<int>(kind)];
}

const char* clutterLawName(ClutterLaw law) {
  static constexpr const char* kNames[kClutterLaws] = {"none", "null_task, last link",
                                                       "null_limit"};
  return kNames[static_cast<int>(law)];
}

std::vector<RunSetup> drawClutter(const RunSetup& base, ClutterKind kind, int posts,
                                  std::uint64_t seed, int count) {
  BenchRandom draw(seed);
  RunSetup bare = base;
  bare.plant.obstacles.clear();
  for (TactileModuleConfig& module : bare.controller.tactile_modules) module.max_force_N = kNoLimit;
  for (SimulatedModuleConfig& module : bare.plant.modules) module.quantised = false;
  const double height_m = tipAt(bare.controller).z();
  const double tip_radius_m = bare.plant.modules.back().cover_radius_m;
  std::vector<RunSetup> setups(static_cast<std::size_t>(count), bare);
  for (RunSetup& setup : setups) {
    const Vector3 goal = drawGoal(draw);
    setGoal(goal, setup);
    std::vector<Vector3> places;
    while (static_cast<int>(places.size()) < posts) {
      const Vector3 place = drawPlace(draw);
      if (!isFree(place, {goal}, tip_radius_m + kPostRadius_m) ||
          !isFree(place, places, 2.0 * kPostRadius_m))
        continue;
      places.push_back(place);
      setup.plant.obstacles.push_back(postAt(place, height_m, kind));
    }
  }
  return setups;
}

void useLaw(ClutterLaw law, RunSetup& setup) {
  if (law == ClutterLaw::kNone) setup.controller.force_control.reset();
  if (law != ClutterLaw::kNullTask) return;
  keepOneModule(setup.controller.chain.size() - 1, setup);
  setup.controller.force_control->variant = Variant::kNullTask;
}

}  // namespace tactus
