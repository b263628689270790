#include "tactus/scene/key_table.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "support/hardware_files.h"
#include "tactus/scene/table_reader.h"

namespace tactus {
namespace {

/// Calls `visit(path, spec)` for every row, depth first.
template <class Visit>
void walk(const std::vector<KeySpec>& keys, const std::string& prefix, const Visit& visit) {
  for (const KeySpec& spec : keys) {
    visit(prefix + spec.key, spec);
    walk(spec.keys, prefix + spec.key + ".", visit);
  }
}

template <class Visit>
void walkBoth(const Visit& visit) {
  walk(sceneKeys(), "scene:", visit);
  walk(robotKeys(), "robot:", visit);
}

TEST(KeyTable, EveryRowIsComplete) {
  walkBoth([](const std::string& path, const KeySpec& spec) {
    SCOPED_TRACE(path);
    const bool is_section =
        spec.type == ValueType::kSection || spec.type == ValueType::kSectionList;
    EXPECT_FALSE(spec.doc.empty());
    EXPECT_EQ(spec.doc.find('\n'), std::string::npos);
    EXPECT_FALSE(describeExpectation(spec).empty());
    EXPECT_EQ(std::holds_alternative<std::monostate>(spec.target), is_section);
    EXPECT_EQ(spec.type == ValueType::kSectionList && !spec.begin, false);
    EXPECT_EQ(spec.presence == Presence::kDefaulted && !is_section, !spec.default_value.empty());
  });
}

TEST(KeyTable, KeysOfASectionAreUnique) {
  std::set<std::string> paths;
  walkBoth([&](const std::string& path, const KeySpec&) {
    EXPECT_TRUE(paths.insert(path).second) << path;
  });
  EXPECT_GT(paths.size(), 60u);
}

TEST(KeyTable, KeysEndInTheirUnit) {
  const std::vector<std::pair<std::string, std::string>> suffixes = {{"N", "_N"},
                                                                     {"N/m", "_N_per_m"},
                                                                     {"m", "_m"},
                                                                     {"s", "_s"},
                                                                     {"m/s", "_m_per_s"},
                                                                     {"rad", "_rad"},
                                                                     {"rad/s", "_rad_per_s"},
                                                                     {"Hz", "_hz"},
                                                                     {"1/s", "_per_s"},
                                                                     {"1/N", "_per_N"},
                                                                     {"1/m", "_per_m"},
                                                                     {"1/rad", "_per_rad"}};
  walkBoth([&](const std::string& path, const KeySpec& spec) {
    for (const auto& [unit, suffix] : suffixes) {
      if (spec.unit != unit) continue;
      EXPECT_TRUE(spec.key.ends_with(suffix)) << path;
    }
  });
}

/// The structs are filled by hand in tests: their initialisers and the table must not drift apart.
TEST(KeyTable, DefaultsEqualThoseOfTheStructs) {
  test::SceneFiles files;
  files.scene =
      "robot: robot.yaml\ntask: {trajectory: {line: {displacement_m: [0, 0.1, 0]}}}\n"
      "redundancy: {joint_limit_avoidance: {}}\n"
      "controller: {variant: null_space}\nstiffness: {assumed_N_per_m: 7000, estimate: {}}\n"
      "simulation: {duration_s: 1}\n";
  files.robot = test::replaced(files.robot, "  sample_period_s: 0.005\n", "");
  files.robot = test::replaced(files.robot, "drives: {position_lag_s: 0.01}\n", "");
  const Scene scene = files.load();
  EXPECT_EQ(scene.controller.force_control->order, ForceControlConfig{}.order);
  EXPECT_TRUE(isSame(scene.controller.gains, Gains{}));
  const Waypoint& waypoint = scene.controller.task.trajectory.waypoints[0];
  EXPECT_EQ(waypoint.speed_m_per_s, Waypoint{}.speed_m_per_s);
  EXPECT_EQ(waypoint.angular_speed_rad_per_s, Waypoint{}.angular_speed_rad_per_s);
  EXPECT_EQ(waypoint.ramp_s, Waypoint{}.ramp_s);
  const TactileModuleConfig module_default;
  EXPECT_EQ(scene.controller.tactile_module->max_force_N, module_default.max_force_N);
  EXPECT_EQ(scene.controller.tactile_module->max_sample_age_s, module_default.max_sample_age_s);
  EXPECT_EQ(scene.controller.tactile_module->filter_cutoff_hz, module_default.filter_cutoff_hz);
  EXPECT_EQ(scene.controller.drive_lag_s,
            ControllerConfig{.chain = scene.controller.chain}.drive_lag_s);
  const LogConfig log_default;
  EXPECT_EQ(scene.log.max_bytes, log_default.max_bytes);
  EXPECT_EQ(scene.log.keep, log_default.keep);
  EXPECT_EQ(scene.log.min_free_bytes, log_default.min_free_bytes);
  const PlantConfig plant_default;
  EXPECT_EQ(scene.plant.drive_lag_s, plant_default.drive_lag_s);
  EXPECT_EQ(scene.plant.module.filter_cutoff_hz, plant_default.module.filter_cutoff_hz);
  EXPECT_EQ(scene.plant.module.filter_rate_hz, plant_default.module.filter_rate_hz);
  EXPECT_EQ(scene.plant.module.sample_period_s, plant_default.module.sample_period_s);
  EXPECT_EQ(scene.plant.module.counts_per_N, plant_default.module.counts_per_N);
  EXPECT_EQ(scene.plant.module.quantised, plant_default.module.quantised);
  EXPECT_EQ(scene.plant.module.noise_N, plant_default.module.noise_N);
  EXPECT_EQ(scene.plant.module.lost_share, plant_default.module.lost_share);
  EXPECT_EQ(scene.plant.module.seed, plant_default.module.seed);
}

/// One number below and one above what a range allows.
std::vector<double> outside(const Range& range) {
  std::vector<double> values;
  const double step = 1e-6 * std::max(1.0, std::abs(range.lower));
  values.push_back(range.lower_open ? range.lower : range.lower - step);
  values.push_back(range.upper * (1.0 + 1e-6));
  return values;
}

/// Sets a number of a file, given as a tree, to `value` and reads it.
std::string readError(YamlNode root, const std::vector<KeySpec>& keys, const std::string& path,
                      double value) {
  try {
    applyOverride(root, {path, fmt::format("{}", value)});
    ConfigDraft draft;
    readSection(root, keys, "", draft);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Calls `visit` for every number; of lists, for their first entry.
template <class Visit>
void walkNumbers(const std::vector<KeySpec>& keys, const std::string& prefix, const Visit& visit) {
  for (const KeySpec& spec : keys) {
    const bool is_list = spec.type == ValueType::kSectionList;
    if (spec.type == ValueType::kNumber || spec.type == ValueType::kInteger) {
      visit(prefix + spec.key, spec);
    }
    walkNumbers(spec.keys, prefix + spec.key + (is_list ? "[0]." : "."), visit);
  }
}

/// Every number, set to a value just outside its range, is refused under its own key: no row is
/// forgotten by the reader.
int countRefused(const std::string& text, const std::vector<KeySpec>& keys) {
  const YamlNode root = parseYaml({"file.yaml", text});
  int refused = 0;
  walkNumbers(keys, "", [&](const std::string& path, const KeySpec& spec) {
    for (double value : outside(spec.range)) {
      if (spec.type == ValueType::kInteger) {
        value = value < spec.range.lower ? spec.range.lower - 1 : spec.range.upper + 1;
      }
      const std::string error = readError(root, keys, path, value);
      EXPECT_NE(error.find(": " + path + ": "), std::string::npos) << path << " " << error;
      EXPECT_TRUE(error.find("out of range") != std::string::npos ||
                  error.find("is not a whole number") != std::string::npos)
          << path << " " << value << " " << error;
      ++refused;
    }
  });
  return refused;
}

TEST(KeyTable, NoNumberOutsideItsRangeIsRead) {
  std::string scene = test::kSceneText;
  scene = test::replaced(scene, "{x_m: 0.7, y_m: 0.1, stiffness_N_per_m: 60}",
                         "{x_m: 1, y_m: 1, stiffness_N_per_m: 1, foam: [{stiffness_N_per_m: 1, "
                         "until_force_N: 1}]}");
  scene = test::replaced(scene, "redundancy:", "    waypoints: [{}]\nredundancy:");
  scene += "  troubles: [{kind: drop, from_s: 1, until_s: 2}]\n";
  EXPECT_GT(countRefused(scene, sceneKeys()), 80);
  const std::string robot = test::replaced(test::kHardwareRobotText, "  brake: {line: 5}",
                                           "  enable: {line: 4}\n  brake: {line: 5}");
  EXPECT_GT(countRefused(robot, robotKeys()), 60);
}

}  // namespace
}  // namespace tactus
