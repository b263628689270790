#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "tactus/sim/plant_config.h"

namespace tactus::physics {

/// A capsule along the x axis of a link's frame, from its origin, m.
struct MujocoCover {
  AttachedFrame link;
  double length_m, radius_m;
};

/// A light body, free along x, y and z, that covers collide with: a thin vertical capsule, or a
/// sphere or a wide wall that is thicker by as much. Whoever moves it adds its spring and damper.
struct MujocoPost {
  Vector3 p_Base;    ///< m
  std::string geom;  ///< its shape, in MJCF
  double mass_kg;
  double friction_coefficient;
};

inline constexpr double kPostRadius_m = 0.001;

/// Throws std::invalid_argument for lines and posts by their shape.
MujocoPost mujocoPost(const ObstacleConfig& obstacle, double mass_kg);

/// What an arm is among.
struct MujocoWorld {
  std::vector<MujocoCover> covers;
  std::vector<MujocoPost> posts;
  double step_s;
};

/// The arm in MJCF: "motor<i>" is the motor's angle at the joint, with the rotor as its armature;
/// behind a flexible gear "gear<i>" turns about the same axis, with the gear's spring and damper,
/// and the link stands at the sum of both. Actuator i gives ctrl[i] to motor i, and gets its
/// servo's gains from whoever knows the start. No gravity. Throws std::invalid_argument for a cover
/// on the base.
std::string mujocoText(const SerialChain& chain, const ArmDynamicsConfig& arm,
                       const MujocoWorld& world);

struct MujocoDeleter {
  void operator()(mjModel* model) const noexcept { mj_deleteModel(model); }
  void operator()(mjData* data) const noexcept { mj_deleteData(data); }
};
using MujocoModel = std::unique_ptr<mjModel, MujocoDeleter>;
using MujocoData = std::unique_ptr<mjData, MujocoDeleter>;

/// Of a contact between two bodies at rest, N/m, as MuJoCo's documentation has it under "Solver
/// parameters": f = d k r / R, with R = (1 - d) / d (w_1 + w_2), k = 1 / (d time damping)^2.
double contactStiffness(const mjModel& model, int body, int other_body);

/// Throws std::runtime_error with what MuJoCo says.
MujocoModel loadMujoco(const std::string& text);

}  // namespace tactus::physics
