#pragma once

#include <memory>
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

struct YamlNode;

/// A file that a scene was made of, as it was read: logged with every run, so that a log alone can
/// be replayed.
struct SourceFile {
  std::string path;  ///< as the scene names it
  std::string text;
};

/// A value given on the command line: --set controller.time_constant_s=0.2
struct Override {
  std::string key;
  std::string value;
};

inline constexpr double kDefaultPeriod_s = 0.001;

/// What robot.yaml and URDF say of the masses, rotors and gears of the arm, simulated or not.
struct ArmDescription {
  ArmDynamicsConfig dynamics;
  bool has_gears = false;  ///< else they are rigid: the stiffness of none is said
  double contact_stiffness_N_per_m = kNoLimit;  ///< of links and cover, what a blow meets of them
  JointVector max_effort;                       ///< N or Nm; infinite where the URDF has none
};

/// Of what ClearanceConfig has: links as the URDF spells them, and keys of bodies.
struct ClearanceNames {
  std::vector<std::string> capsules, walls;
  std::vector<CapsulePair> touching;  ///< left out, as they always touch
};

/// One run: a robot, a task, a controller and, for simulation, a world.
struct Scene {
  std::string name;  ///< file name without .yaml
  ControllerConfig controller;
  std::string variant;  ///< as the scene spells it; "none" without force control
  double period_s = kDefaultPeriod_s;
  double duration_s = 0.0;
  double stiffest_N_per_m = 0.0;  ///< contact that the gains are made for; 0: as assumed
  PlantConfig plant;
  /// Absent without `dynamics` in robot.yaml, and where a joint moves no mass.
  std::optional<ArmDescription> arm{};
  std::string robot_name;  ///< as the URDF spells it
  std::vector<std::string> joint_names;
  std::vector<std::string> module_links;  ///< of the tactile modules that the controller reads
  /// The scene first, then what it extends, the robot, what its drives name, the URDF.
  std::vector<SourceFile> sources;
  std::size_t scene_sources = 0;  ///< of these, from the first on, are the scene's own
  std::vector<Override> overrides;
  /// Every number of scene and robot, defaults included, by dotted path: for the log's readers.
  std::vector<std::pair<std::string, double>> numbers;
  /// What this scene needs of the machine, without buses on which nothing of it is; absent: the
  /// robot only simulates.
  std::optional<HardwareConfig> hardware{};
  LogConfig log{};
  std::vector<std::string> capsule_links{};  ///< of plant.capsules, as the URDF spells them
  ClearanceNames clearance{};                ///< empty without controller.clearance
  std::vector<Trouble> troubles{};           ///< of the plant on the buses; simulation has none
  /// The scene with all it extends, for errors that are found later; null if it was not read.
  std::shared_ptr<const YamlNode> tree{};
};

/// Whether the scene begins where the arm is: task.commands.start_measured.
bool startsMeasured(const Scene& scene);

/// Whether somebody has to ask for each motion: a robot on hardware with gpio.enable.
bool hasEnableLine(const Scene& scene);

/// The stages that exist in this scene, in the order of a cycle, by the names of the contract.
std::vector<std::string> stageNames(const ControllerConfig& config);

/// The stages that a run on this hardware has besides.
std::vector<std::string> hardwareStageNames(const HardwareConfig& hardware);

}  // namespace tactus
