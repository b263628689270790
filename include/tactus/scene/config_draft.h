#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/control/controller_config.h"
#include "tactus/plant/trouble.h"
#include "tactus/scene/log_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// What a drive's entry says in m or in rad. Which of the two may stand there is known only with
/// the joint.
struct DriveUnits {
  double counts_per_unit = 0.0;
  double offset = DriveConfig{}.offset;
  double max_following_error = DriveConfig{}.max_following_error;
};

struct DriveDraft {
  std::string joint;      ///< name in the URDF
  std::string interface;  ///< of its bus
  DriveConfig config;     ///< without joint, bus and what depends on the unit
  DriveUnits metres, radians;
};

struct TroubleDraft {
  std::string kind;
  std::string interface;  ///< empty: none given
  Trouble trouble;        ///< without kind, bus and id
  int id = 0;
};

/// Everything the files of a scene say, each value checked for itself but not yet against the
/// others; becomes a Scene.
struct ConfigDraft {
  // Scene.
  std::string extends;
  std::string robot;  ///< path as written
  double period_s = 0.0;
  double duration_s = 0.0;
  std::vector<double> start;  ///< empty: the robot's home
  std::vector<std::string> components;
  TaskConfig task;
  std::vector<double> weights;  ///< empty: all 1
  bool has_joint_limit_avoidance = false;
  std::string variant = "none";
  ForceControlConfig force;
  Gains gains;
  double stiffest_N_per_m = 0.0;  ///< 0: not given
  PlantConfig plant;              ///< as robot.yaml describes the arm
  double simulated_drive_lag_s = 0.0, simulated_filter_cutoff_hz = 0.0;  ///< if given, other ones
  std::vector<TroubleDraft> troubles;
  LogConfig log;

  // Robot.
  std::string urdf;  ///< path as written
  std::string tip;
  std::vector<double> home;
  std::vector<double> max_acceleration;  ///< empty: no limit
  std::string module_link;
  TactileModuleConfig module;
  std::vector<BusConfig> buses;
  CanopenConfig canopen;
  std::vector<DriveDraft> drives;
  double start_tolerance = HardwareConfig{}.start_tolerance;
  CanTactileConfig can_tactile;  ///< only what the module of PlantConfig does not have
  std::string module_interface;
  int module_first_id = 0;
  bool filter_in_daemon = false;
  std::optional<GpioConfig> gpio;

  // Both.
  RealTimeConfig real_time;
  std::vector<std::pair<std::string, double>> numbers;  ///< all of them, by dotted path, as read
};

}  // namespace tactus
