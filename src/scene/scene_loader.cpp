#include "tactus/scene/scene_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "tactus/scene/hardware_checks.h"
#include "tactus/scene/hardware_loader.h"
#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_checks.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/table_reader.h"

namespace tactus {
namespace {

constexpr std::size_t kMaxExtends = 8;

/// Reads a scene file and lays it over the one it extends. `above` are the files that led here.
YamlNode readScene(const SourceFile& file, SourceReader& reader, std::vector<std::string> above) {
  YamlNode scene = parseYaml(file);
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
      failAt({std::make_shared<std::string>("--set " + setting.key), 1, 1}, setting.key,
             "cannot be set here", "expected in a file");
    }
    applyOverride(root, setting);
  }
}

/// The robot's path is meant relative to the file that names it; on the command line, to the scene.
std::string robotPath(const YamlNode& root, const std::string& scene_path, const std::string& robot,
                      const std::vector<Override>& overrides) {
  const bool is_overridden = std::ranges::count(overrides, "robot", &Override::key) > 0;
  return resolvePath(is_overridden ? scene_path : *locate(root, "robot").file, robot);
}

JointVector readStart(const YamlNode& root, const ConfigDraft& draft, const LoadedRobot& robot) {
  if (draft.start.empty()) return toJointVector(draft.home, robot.root, "home", robot.chain);
  const JointVector q_start = toJointVector(draft.start, root, "start", robot.chain);
  checkWithinLimits(q_start, root, "start", robot.chain);
  return q_start;
}

ControllerConfig makeController(const YamlNode& root, const ConfigDraft& draft,
                                const LoadedRobot& robot, const JointVector& q_start) {
  const UrdfChain& chain = robot.chain;
  const auto joint_count = static_cast<Eigen::Index>(chain.joints.size());
  ControllerConfig config{
      .chain = SerialChain(chain.joints, chain.tip), .q_start = q_start, .limits = chain.limits};
  config.task = draft.task;
  config.task.size = static_cast<int>(draft.components.size());
  for (int i = 0; i < config.task.size; ++i) {
    config.task.components[i] = static_cast<int>(
        std::ranges::find(componentNames(), draft.components[i]) - componentNames().begin());
  }
  config.weights = draft.weights.empty()
                       ? JointVector::Ones(joint_count)
                       : toJointVector(draft.weights, root, "redundancy.weights", chain);
  config.has_joint_limit_avoidance = draft.has_joint_limit_avoidance;
  config.gains = draft.gains;
  if (!findGiven(root, "controller")) return config;
  config.tactile_module = draft.module;
  config.tactile_module->filter_cutoff_hz = draft.plant.module.filter_cutoff_hz;
  config.drive_lag_s = draft.plant.drive_lag_s;
  if (draft.variant == "none") return config;
  config.force_control = draft.force;
  config.force_control->variant = static_cast<Variant>(
      std::ranges::find(variantNames(), draft.variant) - variantNames().begin());
  return config;
}

/// The robot as it is simulated, which may differ from the one that the controller reckons with.
PlantConfig makePlant(const YamlNode& root, const ConfigDraft& draft) {
  PlantConfig plant = draft.plant;
  if (findGiven(root, "simulation.drive_lag_s")) plant.drive_lag_s = draft.simulated_drive_lag_s;
  if (findGiven(root, "simulation.tactile_module.filter_cutoff_hz"))
    plant.module.filter_cutoff_hz = draft.simulated_filter_cutoff_hz;
  return plant;
}

/// What the scene needs of the robot's hardware: without a controller, the module is not read.
std::optional<HardwareConfig> chooseHardware(const YamlNode& root, const LoadedRobot& robot) {
  if (!robot.hardware || findGiven(root, "controller")) return robot.hardware;
  return withoutTactileModule(*robot.hardware);
}

/// A scene's name is that of its file, and the name of a folder with its results.
std::string sceneName(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  if (name.find_first_not_of('.') == std::string::npos) {
    failAt({std::make_shared<std::string>(path), 1, 1}, "-", "the file has no name of its own",
           "expected name.yaml");
  }
  return name;
}

Scene loadNamed(const std::string& path, const std::vector<Override>& overrides, SceneUse use,
                FileProvider provider) {
  SourceReader reader(std::move(provider));
  YamlNode root = readScene(reader.readFirst(path), reader, {});
  applyOverrides(root, overrides);
  ConfigDraft draft;
  readSection(root, sceneKeys(), "", draft);
  const std::string robot_path = robotPath(root, path, draft.robot, overrides);
  const LoadedRobot robot =
      loadRobot(reader.read(robot_path, "robot", locate(root, "robot")), reader, draft);
  const JointVector q_start = readStart(root, draft, robot);
  checkScene(root, draft, robot, q_start);
  const std::optional<HardwareConfig> hardware = chooseHardware(root, robot);
  if (hardware && use == SceneUse::kHardware) checkHardware(root, robot.root, draft, *hardware);
  Scene scene{.name = sceneName(path),
              .controller = makeController(root, draft, robot, q_start),
              .variant = draft.variant,
              .period_s = draft.period_s,
              .duration_s = draft.duration_s,
              .stiffest_N_per_m = draft.stiffest_N_per_m,
              .plant = makePlant(root, draft),
              .robot_name = robot.chain.robot_name,
              .joint_names = robot.chain.joint_names,
              .sources = reader.files(),
              .overrides = overrides,
              .numbers = std::move(draft.numbers),
              .hardware = hardware,
              .log = draft.log,
              .troubles = loadTroubles(root, draft, hardware),
              .tree = std::make_shared<const YamlNode>(root)};
  return scene;
}

/// An error in another file says which scene led there.
Scene load(const std::string& path, const std::vector<Override>& overrides, SceneUse use,
           FileProvider provider) {
  try {
    return loadNamed(path, overrides, use, std::move(provider));
  } catch (const InputError& error) {
    const std::string_view text = error.what();
    const std::string scene = escaped(path);
    if (text.starts_with(scene + ":") || text.starts_with("--set ")) throw;
    throw InputError(fmt::format("{} (for the scene {})", text, scene));
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

Override parseOverride(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    failAt({std::make_shared<std::string>("--set"), 1, 1}, "-", inQuotes(text) + " sets nothing",
           "expected section.key=value");
  }
  return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

}  // namespace tactus
