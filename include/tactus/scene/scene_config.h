#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/control/controller_config.h"
#include "tactus/plant/trouble.h"
#include "tactus/scene/log_config.h"
#include "tactus/scene/robot_config.h"
#include "tactus/scene/scene.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

struct HoldSection {};

/// Exactly one of line, waypoints and hold is given.
struct TrajectorySection {
  double start_s = TrajectoryConfig{}.start_s;
  std::optional<Waypoint> line;
  std::vector<Waypoint> waypoints;
  std::optional<HoldSection> hold;
};

enum class TaskSource : std::uint8_t { kTrajectory, kCommands };

struct PostureSection {
  std::optional<std::vector<double>> positions;  ///< absent: the robot's home
};

struct StiffnessSection {
  std::optional<double> stiffest_N_per_m;
  bool has_estimate = false;
};

struct TroubleSection {
  Trouble trouble;  ///< without bus, id and delay, which not all kinds have
  std::optional<std::string> interface;
  std::optional<std::uint32_t> id;
  std::optional<double> delay_s;
};

/// What the simulated arm is: a line that follows its drives, or bodies that they move.
enum class SimulatedArm : std::uint8_t { kQuasiStatic, kRigidGears, kFlexibleGears };

/// Which side of its gear a drive's encoder measures.
enum class EncoderSide : std::uint8_t { kMotor, kLink };

/// What drives do beside following; lists have one entry a joint.
struct SimulatedDrivesSection {
  std::optional<double> bandwidth_hz;
  std::optional<double> damping_ratio;
  double dead_time_s = DriveEffectsConfig{}.dead_time_s;
  std::optional<std::vector<double>> max_acceleration, max_torque;
  std::optional<std::vector<double>> coulomb_friction, viscous_friction, backlash;
  EncoderSide feedback = EncoderSide::kMotor;
};

struct SimulationSection {
  double duration_s = 0.0;
  SimulatedArm arm = SimulatedArm::kQuasiStatic;
  std::optional<double> drive_lag_s;  ///< another one than robot.yaml says
  std::optional<SimulatedDrivesSection> drives;
  std::optional<double> filter_cutoff_hz;  ///< of the tactile module: another one, too
  SimulatedModuleConfig module;            ///< its imperfections alone
  std::optional<CoverSection> cover;       ///< another one, too
  std::optional<std::vector<double>> link_length_errors_m;
  std::vector<ObstacleConfig> obstacles;
  std::vector<TroubleSection> troubles;
};

/// Which links keep clear of a body.
enum class KeptLinks : std::uint8_t { kAll, kTool };

/// Exactly one of the shapes is given.
struct KeepOutSection {
  std::optional<PlaneConfig> plane;
  std::optional<SphereConfig> sphere;
  std::optional<PostConfig> post;
  KeptLinks links = KeptLinks::kAll;
};

/// Names in the URDF.
struct ExcludedPair {
  std::string link, other;
};

struct ClearanceSection {
  double safe_distance_m = ClearanceConfig{}.safe_distance_m;
  double influence_distance_m = ClearanceConfig{}.influence_distance_m;
  std::optional<ClearanceAvoidance> avoid;
  bool self_collision = true;
  std::vector<ExcludedPair> exclude;
  std::vector<KeepOutSection> keep_out;
};

/// The position of the tool; with a rotation only if a scene says so.
inline TaskConfig positionTask() {
  TaskConfig task;
  task.components = {0, 1, 2};
  task.size = 3;
  return task;
}

/// What a scene file says, with all that it extends: each value checked for itself, not yet against
/// the others and the robot.
struct SceneConfig {
  std::optional<std::string> extends;
  std::string robot;  ///< path as written
  double period_s = kDefaultPeriod_s;
  std::optional<std::vector<double>> start;  ///< absent: the robot's home
  Gains gains;                               ///< of all sections below
  TaskConfig task = positionTask();          ///< without trajectory
  TaskSource source = TaskSource::kTrajectory;
  std::optional<TrajectorySection> trajectory;
  std::optional<std::vector<double>> weights;  ///< absent: all 1
  bool has_joint_limit_avoidance = false;
  std::optional<PostureSection> posture;
  std::optional<ForceControlConfig> controller;  ///< without what `stiffness` says
  std::optional<StiffnessSection> stiffness;
  std::optional<ClearanceSection> clearance;
  SimulationSection simulation;
  bool requires_real_time = RealTimeConfig{}.required;
  LogConfig log;
};

}  // namespace tactus
