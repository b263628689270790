#include "tactus/scene/robot_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/scene/capsule_loader.h"
#include "tactus/scene/hardware_loader.h"
#include "tactus/scene/table_reader.h"
#include "tactus/scene/tactile_loader.h"

namespace tactus {
namespace {

/// Of two modules one may be lost.
void checkModuleLost(const YamlNode& root, const RobotConfig& config) {
  const char* const key = "module_lost";
  const char* const share_key = "module_lost_speed_share";
  if (findGiven(root, share_key) && !findGiven(root, key)) {
    failAt(locate(root, share_key), share_key, "there is no module_lost, so the arm stops",
           "expected module_lost: go_on_slowly beside it");
  }
  const std::size_t modules = config.tactile_modules.size();
  if (config.module_lost == ModuleLost::kStop || modules > 1) return;
  failAt(locate(root, key), key, fmt::format("the robot has {} tactile module", modules),
         "expected stop, or tactile_modules with two or more");
}

}  // namespace

JointVector toJointVector(const std::vector<double>& values, const YamlNode& root,
                          const std::string& path, const UrdfChain& chain) {
  if (values.size() != chain.joints.size()) {
    failAt(locate(root, path), path, fmt::format("a list of {}", values.size()),
           fmt::format("expected {} numbers, one a moving joint", chain.joints.size()));
  }
  return Eigen::Map<const JointVector>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void checkWithinLimits(const JointVector& q, const YamlNode& root, const std::string& path,
                       const UrdfChain& chain) {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double lower = chain.limits.lower[i];
    const double upper = chain.limits.upper[i];
    if (q[i] >= lower && q[i] <= upper) continue;
    const std::string key = fmt::format("{}[{}]", path, i);
    failAt(
        locate(root, key), key,
        fmt::format("{} is outside the limits of joint {}", q[i], inQuotes(chain.joint_names[i])),
        fmt::format("expected {} to {}", lower, upper));
  }
}

std::string SceneSettings::resolve(const std::string& named_in, std::string_view key,
                                   const std::string& reference) const {
  const bool is_set = std::ranges::count(overrides, key, &Override::key) > 0;
  return resolvePath(is_set ? scene_path : named_in, reference);
}

LoadedRobot loadRobot(const SourceFile& file, const SceneSettings& settings, SourceReader& reader,
                      NamedNumbers& numbers) {
  YamlNode root = reader.parse(file);
  for (const Override& setting : settings.overrides) {
    if (!setting.key.starts_with(kRobotPrefix)) continue;
    const std::string_view path = std::string_view(setting.key).substr(kRobotPrefix.size());
    dropOtherSpelling(root, path);
    applyOverride(root, setting, modulePathIn(root, path));
  }
  RobotConfig config = readRobotConfig(root, numbers);
  std::vector<DriveSheet> sheets = readDriveSheets(file, root, config, settings, reader);
  const SourceFile urdf = reader.read(settings.resolve(file.path, "robot.urdf", config.urdf),
                                      "urdf", locate(root, "urdf"));

  const NamedFrame tip{config.tip, "tip", locate(root, "tip")};
  checkModules(root, config.tactile_modules);
  checkModuleLost(root, config);
  UrdfChain chain = loadUrdfChain(urdf, tip, moduleLinks(root, config.tactile_modules),
                                  capsuleLinks(root, config.collision_capsules));
  checkWithinLimits(toJointVector(config.home, root, "home", chain), root, "home", chain);
  if (config.max_acceleration) {
    chain.limits.max_acceleration =
        toJointVector(*config.max_acceleration, root, "limits.acceleration", chain);
  }
  for (std::size_t i = 0; i < chain.module_links.size(); ++i)
    config.tactile_modules[i].config.link = chain.module_links[i];
  std::optional<HardwareConfig> hardware = loadHardware(root, config, chain, sheets);
  std::vector<BodyInertia> bodies;
  if (config.dynamics) bodies = loadUrdfBodies(urdf, chain);
  return {std::move(root),   std::move(config),   std::move(chain),
          std::move(bodies), std::move(hardware), std::move(sheets)};
}

}  // namespace tactus
