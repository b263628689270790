#include "tactus/scene/scene_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tactus/scene/avoidance_check.h"
#include "tactus/scene/capsule_loader.h"
#include "tactus/scene/clearance_loader.h"
#include "tactus/scene/cover_keys.h"
#include "tactus/scene/drive_effects_loader.h"
#include "tactus/scene/dynamics_loader.h"
#include "tactus/scene/hardware_checks.h"
#include "tactus/scene/hardware_loader.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/link_errors.h"
#include "tactus/scene/parsed_scene.h"
#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_checks.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/table_reader.h"

namespace tactus {
namespace {

constexpr std::size_t kMaxExtends = 8;

/// Reads a scene file and lays it over the one it extends. `above` are the files that led here.
YamlNode readScene(const SourceFile& file, SourceReader& reader, std::vector<std::string> above) {
  YamlNode scene = reader.parse(file);
  const auto extends = std::ranges::find(scene.entries, "extends", &YamlEntry::key);
  if (extends == scene.entries.end() || extends->value.kind == YamlNode::Kind::kNull) return scene;
  const YamlNode& base = extends->value;
  if (base.kind != YamlNode::Kind::kScalar || base.text.empty()) {
    failAt(base.at, "extends", describe(base), "expected the path of a scene");
  }
  above.push_back(file.path);
  const std::string base_path = resolvePath(file.path, base.text);
  if (std::ranges::count(above, base_path) > 0) {
    failAt(base.at, "extends", inQuotes(base.text) + " leads back to a file on the way here",
           "expected no circle");
  }
  if (above.size() > kMaxExtends) {
    failAt(base.at, "extends", "too many files in a row",
           fmt::format("expected at most {}", kMaxExtends));
  }
  const SourceFile base_file = reader.read(base_path, "extends", base.at);
  scene.entries.erase(extends);
  YamlNode merged = readScene(base_file, reader, above);
  mergeYaml(merged, std::move(scene));
  return merged;
}

void applyOverrides(YamlNode& root, const std::vector<Override>& overrides) {
  for (const Override& setting : overrides) {
    if (setting.key == "extends") {
      failAt(beginOf("--set " + setting.key), setting.key, "cannot be set here",
             "expected in a file");
    }
    if (!setting.key.starts_with(kRobotPrefix)) applyOverride(root, setting, setting.key);
  }
}

JointVector readStart(const YamlNode& root, const SceneConfig& config, const LoadedRobot& robot) {
  if (!config.start) return toJointVector(robot.config.home, robot.root, "home", robot.chain);
  const JointVector q_start = toJointVector(*config.start, root, "start", robot.chain);
  checkWithinLimits(q_start, root, "start", robot.chain);
  return q_start;
}

JointVector readPosture(const YamlNode& root, const PostureSection& posture,
                        const LoadedRobot& robot) {
  if (!posture.positions) return toJointVector(robot.config.home, robot.root, "home", robot.chain);
  constexpr const char* kKey = "redundancy.posture.positions";
  const JointVector q = toJointVector(*posture.positions, root, kKey, robot.chain);
  checkWithinLimits(q, root, kKey, robot.chain);
  return q;
}

TaskConfig makeTask(const SceneConfig& config) {
  TaskConfig task = config.task;
  if (config.source == TaskSource::kCommands) {
    if (!task.commands) task.commands.emplace();
    return task;
  }
  const TrajectorySection& trajectory = *config.trajectory;
  task.trajectory = {trajectory.start_s, trajectory.waypoints};
  if (trajectory.line) task.trajectory.waypoints = {*trajectory.line};
  return task;
}

ForceControlConfig makeForceControl(const SceneConfig& config) {
  ForceControlConfig force = *config.controller;
  force.has_estimator = config.stiffness->has_estimate;
  return force;
}

/// Divided by their median, for a common factor, which leaves J# and N of (1) as they are, would
/// weaken W^-1 dH/dq and shift the thresholds of damping and regularised gains, which are lengths.
JointVector withoutScale(JointVector weights) {
  JointVector sorted = weights;
  std::sort(sorted.begin(), sorted.end());
  const Eigen::Index n = sorted.size();
  weights /= std::sqrt(sorted[(n - 1) / 2] * sorted[n / 2]);  // exact where both are equal
  return weights;
}

ControllerConfig makeController(const YamlNode& root, const SceneConfig& config,
                                const LoadedRobot& robot, const JointVector& q_start) {
  const UrdfChain& chain = robot.chain;
  ControllerConfig controller{
      .chain = SerialChain(chain.joints, chain.tip), .q_start = q_start, .limits = chain.limits};
  controller.task = makeTask(config);
  controller.weights =
      config.weights
          ? withoutScale(toJointVector(*config.weights, root, "redundancy.weights", chain))
          : JointVector(JointVector::Ones(q_start.size()));
  controller.has_joint_limit_avoidance = config.has_joint_limit_avoidance;
  if (config.posture) controller.q_posture = readPosture(root, *config.posture, robot);
  controller.gains = config.gains;
  if (!config.controller) return controller;
  for (const TactileModuleSection& module : robot.config.tactile_modules) {
    TactileModuleConfig& read = controller.tactile_modules.emplace_back(module.config);
    read.feels_moment_x = module.channels.moment_x.has_value();
    if (module.cover) read.cover = makeCover(*module.cover, module.config.length_m);
  }
  if (robot.config.module_lost == ModuleLost::kGoOnSlowly)
    controller.module_loss = robot.config.module_loss;
  controller.gravity_Base = robot.config.gravity_Base;
  controller.geared_links = loadGearedLinks(robot, q_start);
  controller.drive_lag_s = robot.config.drives.position_lag_s;
  if (config.controller->variant != Variant::kNone) {
    controller.force_control = makeForceControl(config);
  }
  return controller;
}

/// A module as it is simulated: with the scene's imperfections, and chances of its own.
SimulatedModuleConfig makeSimulatedModule(const SimulationSection& simulation,
                                          const TactileModuleSection& section, std::size_t index) {
  SimulatedModuleConfig module = simulation.module;
  module.seed += index;
  module.cover_radius_m = section.config.cover_radius_m;
  module.filter_rate_hz = section.simulated.filter_rate_hz;
  module.filter_cutoff_hz = section.config.filter_cutoff_hz;
  if (section.filter_in_daemon)
    module.filter_place = FilterPlace::kReader;
  else
    module.filter_cutoff_hz = simulation.filter_cutoff_hz.value_or(module.filter_cutoff_hz);
  module.channels = section.channels;
  const std::optional<CoverSection>& cover = simulation.cover ? simulation.cover : section.cover;
  if (cover && cover->mass_kg > 0.0) module.cover = makeCover(*cover, section.config.length_m);
  return module;
}

/// The robot as it is simulated, which may differ from the one that the controller reckons with.
PlantConfig makePlant(const YamlNode& root, const SceneConfig& config, const LoadedRobot& loaded,
                      const JointVector& q_start, const std::vector<LinkCapsule>& capsules) {
  const SimulationSection& simulation = config.simulation;
  const RobotConfig& robot = loaded.config;
  PlantConfig plant;
  plant.drive_lag_s = simulation.drive_lag_s.value_or(robot.drives.position_lag_s);
  plant.dynamics = loadDynamics(root, simulation.arm, loaded, q_start, config.period_s);
  loadDriveEffects(root, simulation, loaded, config.period_s, plant);
  plant.robot_stiffness_N_per_m = simulation.arm == SimulatedArm::kFlexibleGears
                                      ? robot.dynamics->contact_stiffness_N_per_m.value_or(kNoLimit)
                                      : robot.stiffness_N_per_m;
  plant.obstacles = simulation.obstacles;
  plant.gravity_Base = robot.gravity_Base;
  plant.chain = loadPlantChain(root, simulation.link_length_errors_m, loaded);
  for (std::size_t i = 0; i < robot.tactile_modules.size(); ++i)
    plant.modules.push_back(makeSimulatedModule(simulation, robot.tactile_modules[i], i));
  plant.capsules = capsules;
  return plant;
}

std::vector<std::string> linksThatAreRead(const SceneConfig& config, const RobotConfig& robot) {
  std::vector<std::string> links;
  if (!config.controller) return links;
  for (const TactileModuleSection& module : robot.tactile_modules) links.push_back(module.link);
  return links;
}

/// What the scene needs of the robot's hardware: without a controller, no module is read.
std::optional<HardwareConfig> chooseHardware(const SceneConfig& config, const LoadedRobot& robot) {
  if (!robot.hardware) return std::nullopt;
  HardwareConfig hardware =
      config.controller ? *robot.hardware : withoutTactileModules(*robot.hardware);
  hardware.real_time.required = config.requires_real_time;
  return hardware;
}

/// A scene's name is that of its file, and the name of a folder with its results.
std::string sceneName(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  if (name.find_first_not_of('.') == std::string::npos) {
    failAt(beginOf(path), "-", "the file has no name of its own", "expected name.yaml");
  }
  return name;
}

Scene loadNamed(const std::string& path, const std::vector<Override>& overrides, SceneUse use,
                FileProvider provider, YamlTrees* parsed) {
  SourceReader reader(std::move(provider), parsed);
  YamlNode root = readScene(reader.readFirst(path), reader, {});
  applyOverrides(root, overrides);
  NamedNumbers numbers;
  const SceneConfig config = readSceneConfig(root, numbers);
  const SceneSettings settings{path, overrides};
  const SourcePosition robot_at = locate(root, "robot");
  const std::string robot_path = settings.resolve(*robot_at.file, "robot", config.robot);
  const std::size_t scene_sources = reader.files().size();
  const LoadedRobot robot =
      loadRobot(reader.read(robot_path, "robot", robot_at), settings, reader, numbers);
  const JointVector q_start = readStart(root, config, robot);
  checkScene(root, config, robot, q_start);
  const ControllerConfig controller = makeController(root, config, robot, q_start);
  checkGains(root, controller, config.period_s);
  const NamedCapsules capsules = loadCapsules(robot, config.controller.has_value());
  std::optional<NamedClearance> clearance = loadClearance(root, config, robot, q_start);
  const std::optional<HardwareConfig> hardware = chooseHardware(config, robot);
  if (hardware && use == SceneUse::kHardware) {
    checkHardware(root, robot, config.period_s, *hardware);
  }
  const Variant variant = config.controller ? config.controller->variant : Variant::kNone;
  const StiffnessSection stiffness = config.stiffness.value_or(StiffnessSection{});
  Scene scene{.name = sceneName(path),
              .controller = controller,
              .variant = wordOf(kVariantWords, variant),
              .period_s = config.period_s,
              .duration_s = config.simulation.duration_s,
              .stiffest_N_per_m = stiffness.stiffest_N_per_m.value_or(0.0),
              .plant = makePlant(root, config, robot, q_start, capsules.capsules),
              .arm = describeArm(robot, q_start),
              .robot_name = robot.chain.robot_name,
              .joint_names = robot.chain.joint_names,
              .module_links = linksThatAreRead(config, robot.config),
              .sources = reader.files(),
              .scene_sources = scene_sources,
              .overrides = overrides,
              .numbers = std::move(numbers),
              .hardware = hardware,
              .log = config.log,
              .capsule_links = capsules.links,
              .troubles = loadTroubles(root, config.simulation.troubles, hardware),
              .tree = std::make_shared<const YamlNode>(root)};
  if (clearance) {
    scene.controller.clearance = std::move(clearance->config);
    scene.clearance = std::move(clearance->names);
    checkAvoidance(root, scene.controller, scene.period_s);
  }
  return scene;
}

/// An error in another file says which scene led there.
Scene load(const std::string& path, const std::vector<Override>& overrides, SceneUse use,
           FileProvider provider, YamlTrees* parsed = nullptr) {
  try {
    return loadNamed(path, overrides, use, std::move(provider), parsed);
  } catch (const InputError& error) {
    const std::string_view text = error.what();
    const std::string scene = escaped(path);
    if (text.starts_with(scene + ":") || text.starts_with("--set ")) throw;
    const std::string where = fmt::format(" (for the scene {})", scene);
    const auto* located = dynamic_cast<const LocatedError*>(&error);
    if (!located) throw InputError(error.what() + where);
    ErrorPlace place = located->place;
    place.expected += where;
    throw LocatedError(place);
  }
}

}  // namespace

Scene loadScene(const std::string& path, const std::vector<Override>& overrides, SceneUse use) {
  return load(std::filesystem::path(path).lexically_normal().string(), overrides, use,
              readFromDisk);
}

Scene loadScene(const std::vector<SourceFile>& files, const std::vector<Override>& overrides,
                SceneUse use) {
  return load(files.empty() ? "-" : files.front().path, overrides, use, provideFrom(files));
}

ParsedScene::ParsedScene(std::vector<SourceFile> files) : files_(std::move(files)) {}

Scene ParsedScene::load(const std::vector<Override>& overrides, SceneUse use) {
  return tactus::load(files_.empty() ? "-" : files_.front().path, overrides, use,
                      provideFrom(files_), &trees_);
}

Override parseOverride(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    failAt(beginOf("--set"), "-", inQuotes(text) + " sets nothing", "expected section.key=value");
  }
  return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

}  // namespace tactus
