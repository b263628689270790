#include "tactus/scene/robot_loader.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tactus/scene/hardware_loader.h"
#include "tactus/scene/table_reader.h"

namespace tactus {
namespace {

constexpr const char* kModuleKey = "tactile_module";

void checkModule(const YamlNode& root, const TactileModuleSection& section) {
  const TactileModuleConfig& config = section.config;
  const SimulatedModuleConfig& module = section.electronics;
  const auto fail = [&](const std::string& key, const std::string& problem,
                        const std::string& expectation) {
    const std::string path = std::string(kModuleKey) + "." + key;
    failAt(locate(root, path), path, problem, "expected " + expectation);
  };
  if (config.filter_cutoff_hz >= 0.5 * module.filter_rate_hz) {
    fail("filter_cutoff_hz", fmt::format("{} Hz is too high", config.filter_cutoff_hz),
         fmt::format("less than half the filter's rate of {} Hz", module.filter_rate_hz));
  }
  const double filter_steps = module.sample_period_s * module.filter_rate_hz;
  constexpr double kTolerance = 1e-6;
  if (filter_steps < 0.5 || std::abs(filter_steps - std::round(filter_steps)) > kTolerance) {
    fail("sample_period_s",
         fmt::format("{} s is {} filter periods", module.sample_period_s, filter_steps),
         "a multiple of 1 / filter_rate_hz");
  }
  if (config.max_sample_age_s < module.sample_period_s) {
    fail("max_sample_age_s",
         fmt::format("{} s is shorter than the sample period", config.max_sample_age_s),
         fmt::format("at least {} s", module.sample_period_s));
  }
  Eigen::FullPivLU<Eigen::Matrix<double, 4, 8>> decomposition(module.calibration);
  decomposition.setThreshold(1e-6);
  if (decomposition.rank() < 4) {
    fail("calibration", fmt::format("has rank {}", decomposition.rank()),
         "rows that are linearly independent");
  }
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
  YamlNode root = parseYaml(file);
  for (const Override& setting : settings.overrides) {
    if (setting.key.starts_with(kRobotPrefix)) applyOverride(root, setting, kRobotPrefix.size());
  }
  RobotConfig config = readRobotConfig(root, numbers);
  const SourceFile urdf = reader.read(settings.resolve(file.path, "robot.urdf", config.urdf),
                                      "urdf", locate(root, "urdf"));

  const NamedFrame tip{config.tip, "tip", locate(root, "tip")};
  std::optional<NamedFrame> module_link;
  if (config.tactile_module) {
    const std::string key = std::string(kModuleKey) + ".link";
    module_link = {config.tactile_module->link, key, locate(root, key)};
    checkModule(root, *config.tactile_module);
  }
  UrdfChain chain = loadUrdfChain(urdf, tip, module_link);
  checkWithinLimits(toJointVector(config.home, root, "home", chain), root, "home", chain);
  if (config.max_acceleration) {
    chain.limits.max_acceleration =
        toJointVector(*config.max_acceleration, root, "limits.acceleration", chain);
  }
  if (chain.module_link) config.tactile_module->config.link = *chain.module_link;
  std::optional<HardwareConfig> hardware = loadHardware(root, config, chain);
  return {std::move(root), std::move(config), std::move(chain), std::move(hardware)};
}

}  // namespace tactus
