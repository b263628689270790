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
    EXPECT_EQ(!spec.target, is_section);
    EXPECT_EQ(!spec.enter, !is_section);
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

/// One number below and one above what a range allows.
std::vector<double> outside(const Range& range) {
  std::vector<double> values;
  const double step = 1e-6 * std::max(1.0, std::abs(range.lower));
  values.push_back(range.lower_open ? range.lower : range.lower - step);
  values.push_back(range.upper * (1.0 + 1e-6));
  return values;
}

/// Sets a number of a file, given as a tree, to `value` and reads it.
template <class Read>
std::string readError(YamlNode root, const Read& read, const std::string& path, double value) {
  try {
    applyOverride(root, {path, fmt::format("{}", value)}, path);
    NamedNumbers numbers;
    read(root, numbers);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Calls `visit` for every value; of lists, for their first entry.
template <class Visit>
void walkValues(const std::vector<KeySpec>& keys, const std::string& prefix, const Visit& visit) {
  for (const KeySpec& spec : keys) {
    const bool is_list = spec.type == ValueType::kSectionList;
    if (spec.target) visit(prefix + spec.key, spec);
    if (!spec.same_as.empty()) continue;
    walkValues(spec.keys, prefix + spec.key + (is_list ? "[0]." : "."), visit);
  }
}

/// Every number, set to a value just outside its range, is refused under its own key: no row is
/// forgotten by the reader.
template <class Read>
int countRefused(const std::string& text, const std::vector<KeySpec>& keys, const Read& read) {
  const YamlNode root = parseYaml({"file.yaml", text});
  int refused = 0;
  walkValues(keys, "", [&](const std::string& path, const KeySpec& spec) {
    if (spec.type != ValueType::kNumber && spec.type != ValueType::kInteger) return;
    for (double value : outside(spec.range)) {
      if (spec.type == ValueType::kInteger) {
        value = value < spec.range.lower ? spec.range.lower - 1 : spec.range.upper + 1;
      }
      const std::string error = readError(root, read, path, value);
      EXPECT_NE(error.find(": " + path + ": "), std::string::npos) << path << " " << error;
      EXPECT_TRUE(error.find("out of range") != std::string::npos ||
                  error.find("is not a whole number") != std::string::npos)
          << path << " " << value << " " << error;
      ++refused;
    }
  });
  return refused;
}

std::string fullScene() {
  std::string scene = test::kSceneText;
  scene = test::replaced(scene, "{x_m: 0.7, y_m: 0.1, stiffness_N_per_m: 60}",
                         "{x_m: 1, y_m: 1, stiffness_N_per_m: 1, foam: [{stiffness_N_per_m: 1, "
                         "until_force_N: 1}], swing: {frequency_hz: 1}, "
                         "sphere: {center_m: [0, 0, 0], radius_m: 1}, "
                         "plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}, "
                         "line: {point_m: [0, 0, 0], direction: [0, 0, 1]}, "
                         "post: {foot_m: [0, 0, 0], height_m: 1}}");
  scene = test::replaced(scene, "redundancy:", "    waypoints: [{}]\nredundancy:");
  return scene +
         "  troubles: [{kind: drop, from_s: 1, until_s: 2}]\n"
         "clearance:\n  exclude: [{link: base, other: tool}]\n"
         "  keep_out: [{sphere: {center_m: [0, 0, 0], radius_m: 1}, plane: {point_m: [0, 0, 0], "
         "normal: [0, 0, 1]}, post: {foot_m: [0, 0, 0], height_m: 1}}]\n";
}

std::string fullRobot() {
  const std::string robot =
      test::replaced(test::kHardwareRobotText, "  brake: {line: 5}",
                     "  enable: {line: 4}\n  brake: {line: 5}\n  heartbeat: {line: 6}");
  return test::withModules(robot,
                           test::moduleEntry("cover",
                                             "  interface: can1\n  first_id: 0x110\n  tare: {}\n"
                                             "  cover: {mass_kg: 0.1}\n")) +
         "collision_capsules: [{link: base, from_m: [0, 0, 0], to_m: [0, 0, 0], radius_m: 1}]\n";
}

TEST(KeyTable, NoNumberOutsideItsRangeIsRead) {
  EXPECT_GT(countRefused(fullScene(), sceneKeys(), readSceneConfig), 80);
  EXPECT_GT(countRefused(fullRobot(), robotKeys(), readRobotConfig), 60);
}

/// A default given as it is shown is the same as none: nothing is lost or rounded when it is shown.
template <class Read>
int countDefaults(const std::string& text, const std::vector<KeySpec>& keys, const Read& read) {
  const YamlNode root = parseYaml({"file.yaml", text});
  int defaults = 0;
  walkValues(keys, "", [&](const std::string& path, const KeySpec& spec) {
    if (spec.presence != Presence::kDefaulted) return;
    ++defaults;
    YamlNode given = root, absent = root;
    applyOverride(given, {path, spec.default_value}, path);
    applyOverride(absent, {path, "~"}, path);
    NamedNumbers given_numbers, absent_numbers;
    read(given, given_numbers);
    read(absent, absent_numbers);
    EXPECT_EQ(given_numbers, absent_numbers) << path;
  });
  return defaults;
}

TEST(KeyTable, DefaultsAreShownAsTheyAre) {
  EXPECT_GT(countDefaults(fullScene(), sceneKeys(), readSceneConfig), 40);
  EXPECT_GT(countDefaults(fullRobot(), robotKeys(), readRobotConfig), 25);
}

std::string shownDefault(const std::vector<KeySpec>& keys, const std::string& wanted) {
  std::string text = "no such key";
  walkValues(keys, "", [&](const std::string& path, const KeySpec& spec) {
    if (path == wanted) text = spec.default_value;
  });
  return text;
}

TEST(KeyTable, DefaultsAreThoseOfTheConfigs) {
  EXPECT_EQ(shownDefault(sceneKeys(), "controller.time_constant_s"), "0.1");
  EXPECT_EQ(shownDefault(sceneKeys(), "controller.order"), "2");
  EXPECT_EQ(shownDefault(sceneKeys(), "controller.variant"), "") << "required";
  EXPECT_EQ(shownDefault(sceneKeys(), "controller.activation_force_N"), "") << "optional";
  EXPECT_EQ(shownDefault(sceneKeys(), "stiffness.estimate.max_N_per_m"), "1e6");
  EXPECT_EQ(shownDefault(sceneKeys(), "task.components"), "[x, y, z]");
  EXPECT_EQ(shownDefault(sceneKeys(), "task.trajectory.line.displacement_m"), "[0, 0, 0]");
  EXPECT_EQ(shownDefault(sceneKeys(), "simulation.tactile_module.quantised"), "true");
  EXPECT_EQ(shownDefault(sceneKeys(), "log.min_free_bytes"), "1e8");
  EXPECT_EQ(shownDefault(robotKeys(), "tactile_modules[0].first_id"), "0x100");
  EXPECT_EQ(shownDefault(robotKeys(), "tactile_modules[0].counts_per_N"), "100000");
  EXPECT_EQ(shownDefault(robotKeys(), "real_time.cpu"), "-1");
}

}  // namespace
}  // namespace tactus
