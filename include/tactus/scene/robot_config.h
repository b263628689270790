#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/control/controller_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

struct CanSection {
  std::vector<BusConfig> buses;
  CanopenConfig canopen;
};

/// What a drive's entry says in m or in rad. Which of the two may stand there is known only with
/// the joint.
struct DriveUnits {
  std::optional<double> counts_per_unit, turns_per_unit, offset, max_following_error;
};

struct DriveSection {
  std::string joint;      ///< name in the URDF
  std::string interface;  ///< of its bus
  DriveConfig config;     ///< without joint, bus and what depends on the unit
  DriveUnits metres, radians;
  std::optional<std::string> eds, profile;  ///< paths as written; absent: those of all drives
};

struct DrivesSection {
  double position_lag_s = PlantConfig{}.drive_lag_s;
  double start_tolerance = HardwareConfig{}.start_tolerance;
  std::optional<std::string> eds, profile;  ///< of drives that have none of their own
  std::vector<DriveSection> joints;
};

struct CoverSection {
  double mass_kg = 0.0;
  std::optional<Vector3> center_m;  ///< absent: in the middle
  bool behind_gears = false;        ///< that the drives do not measure
};

struct TactileModuleSection {
  std::string link;                 ///< name in the URDF
  TactileModuleConfig config;       ///< without link
  SimulatedModuleConfig simulated;  ///< filter rate alone
  std::optional<CoverSection> cover;
  TactileChannels channels;
  std::optional<std::string> interface;  ///< of its bus
  CanTactileConfig on_bus;               ///< id and tare alone
  bool filter_in_daemon = false;
};

/// In the frame of its link.
struct CapsuleSection {
  std::string link;  ///< name in the URDF
  Vector3 from_m = Vector3::Zero();
  Vector3 to_m = Vector3::Zero();
  double radius_m = 0.0;
};

/// What an arm with mass is made of beside its bodies, which the URDF has.
struct DynamicsSection {
  std::optional<std::vector<double>> rotor_inertia, gear_stiffness, gear_damping;
  double servo_bandwidth_hz = ArmDynamicsConfig{}.servo_bandwidth_hz;
  double servo_integral_hz = ArmDynamicsConfig{}.servo_integral_hz;
  std::optional<double> contact_stiffness_N_per_m;
};

/// What the arm does when one of several tactile modules is lost.
enum class ModuleLost { kStop, kGoOnSlowly };

/// What a robot.yaml says: each value checked for itself, not yet against the others and the URDF.
struct RobotConfig {
  std::string urdf;  ///< path as written
  std::string tip;
  std::vector<double> home;
  std::optional<std::vector<double>> max_acceleration;  ///< absent: no limit
  Vector3 gravity_Base{0.0, 0.0, -9.81};
  double stiffness_N_per_m = PlantConfig{}.robot_stiffness_N_per_m;
  std::optional<DynamicsSection> dynamics;
  std::optional<CanSection> can;
  DrivesSection drives;
  /// Of `tactile_modules`, or the one of `tactile_module`.
  std::vector<TactileModuleSection> tactile_modules;
  ModuleLost module_lost = ModuleLost::kStop;
  ModuleLossConfig module_loss;  ///< only of kGoOnSlowly
  std::vector<CapsuleSection> collision_capsules;
  std::optional<GpioConfig> gpio;
  RealTimeConfig real_time;
};

}  // namespace tactus
