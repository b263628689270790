#include "tactus/bench/physics_grid.h"

#include <cmath>

#include "tactus/bench/mujoco_robot.h"
#include "tactus/scene/scene_loader.h"

namespace tactus::physics {
namespace {

constexpr double kChaotic = 0.1;
constexpr double kFlexible_N_per_m = 48000.0;  ///< of links and cover of an arm with assumed masses

/// For arms whose robot.yaml has no dynamics: links of 3 kg, halfway to the next joint.
ArmDynamicsConfig assumedMasses(const SerialChain& chain, bool is_flexible) {
  const int n = chain.size();
  ChainPose pose;
  chain.computePose(JointVector::Zero(n), pose);
  ArmDynamicsConfig arm;
  for (int i = 0; i < n; ++i) {
    const Vector3 next = i + 1 < n ? pose.p_BaseJoint[i + 1] : framePosition(pose, chain.tip());
    const Vector3 p = 0.5 * pose.R_BaseJoint[i].transpose() * (next - pose.p_BaseJoint[i]);
    arm.bodies.push_back({3.0, p, 0.02 * Matrix3::Identity()});
  }
  arm.rotor_inertia = JointVector::LinSpaced(n, 1.0, 0.1);
  arm.gear_stiffness = JointVector::Constant(n, is_flexible ? 1e4 : kNoLimit);
  arm.gear_damping = JointVector::Constant(n, 5.0);
  return arm;
}

/// With masses of its own, or else assumed ones.
Scene loadArm(const Case& one, const std::string& scenes_folder) {
  const bool is_flexible = one.gears == Gears::kFlexible;
  const std::string path = scenes_folder + "/" + one.scene + ".yaml";
  if (!one.scene.starts_with("robots/"))
    return loadScene(path, {{"simulation.arm", is_flexible ? "flexible_gears" : "rigid_gears"}},
                     SceneUse::kSimulation);
  Scene scene = loadScene(path, {}, SceneUse::kSimulation);
  scene.plant.dynamics = assumedMasses(scene.controller.chain, is_flexible);
  if (is_flexible) scene.plant.robot_stiffness_N_per_m = kFlexible_N_per_m;
  return scene;
}

/// Infinite where one of them missed the touch, or is no number.
double change(double value, double reference) {
  if (value == 0.0 && reference == 0.0) return 0.0;
  const double change = value / reference - 1.0;
  return std::isfinite(change) ? change : kNoLimit;
}

}  // namespace

const char* gearsName(Gears gears) {
  if (gears == Gears::kRigid) return "rigid";
  return gears == Gears::kBare ? "bare" : "flexible";
}

Scene sceneOf(const Case& one, const std::string& scenes_folder) {
  Scene scene = loadArm(one, scenes_folder);
  if (one.gears == Gears::kBare) scene.plant.robot_stiffness_N_per_m = kNoLimit;
  if (one.stiffness_N_per_m > 0.0) {
    ObstacleConfig obstacle;
    obstacle.x_m = scene.plant.obstacles.back().x_m;
    obstacle.y_m = scene.plant.obstacles.back().y_m;
    obstacle.stiffness_N_per_m = one.stiffness_N_per_m;
    scene.plant.obstacles = {obstacle};
  }
  for (ObstacleConfig& obstacle : scene.plant.obstacles)
    obstacle.friction_coefficient = one.friction_coefficient;
  return scene;
}

Scene quasiStaticSceneOf(const Case& one, const std::string& scenes_folder) {
  Scene scene = sceneOf(one, scenes_folder);
  scene.plant.dynamics.reset();
  return scene;
}

std::vector<Case> paperCases() {
  std::vector<Case> cases;
  for (const char* scene :
       {"scenario1_null_space", "scenario1_tactus", "scenario2_estimated", "scenario2_tactus",
        "scenario3_assumed", "scenario3_estimated", "scenario3_tactus"})
    for (const Gears gears : {Gears::kRigid, Gears::kFlexible})
      for (const double mu : {0.0, 0.3}) cases.push_back({scene, gears, 0.0, mu});
  return cases;
}

std::vector<Case> contactCases() {
  std::vector<Case> cases;
  for (const Gears gears : {Gears::kRigid, Gears::kBare, Gears::kFlexible})
    for (const double mu : {0.0, 0.3, 0.6}) {
      for (const double stiffness : {60.0, 1e3, 1e4, 1e5, 1e6})
        cases.push_back({"scenario3_tactus", gears, stiffness, mu});
      cases.push_back({"scenario3_estimated", gears, 1e4, mu});
    }
  return cases;
}

std::vector<Case> otherArmCases() {
  std::vector<Case> cases;
  for (const Gears gears : {Gears::kRigid, Gears::kBare, Gears::kFlexible})
    for (const double stiffness : {300.0, 1e5})
      for (const double mu : {0.0, 0.3})
        cases.push_back({"robots/kuka_iiwa7_contact", gears, stiffness, mu});
  return cases;
}

double Comparison::error() const {
  return change(built_in.peak_N, mujoco_half ? mujoco_half->peak_N : mujoco.peak_N);
}

bool Comparison::isChaotic() const {
  if (std::abs(change(built_in_half.peak_N, built_in.peak_N)) > kChaotic) return true;
  return mujoco_half && std::abs(change(mujoco_half->peak_N, mujoco.peak_N)) > kChaotic;
}

Comparison compare(const Case& one, const std::string& scenes_folder) {
  const Scene scene = sceneOf(one, scenes_folder);
  Comparison comparison{tryOut(quasiStaticSceneOf(one, scenes_folder), Plant::kBuiltIn),
                        tryOut(scene, Plant::kBuiltIn),
                        tryOut(scene, Plant::kBuiltIn, 0.5 * scene.plant.dynamics->step_s),
                        tryOut(scene, Plant::kMujoco),
                        {}};
  if (std::abs(comparison.error()) > kChaotic)
    comparison.mujoco_half = tryOut(scene, Plant::kMujoco, 0.5 * kMujocoStep_s);
  return comparison;
}

}  // namespace tactus::physics
