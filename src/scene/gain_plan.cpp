#include "tactus/scene/gain_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tactus/control/gain_ramp.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/key_docs.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/stability_check.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

constexpr int kPointsOfTheRamp = 5;

using Values = std::map<std::string, std::string>;

void collect(const YamlNode& node, const std::string& path, Values& values) {
  if (node.kind == YamlNode::Kind::kScalar) values[path] = node.text;
  for (const YamlEntry& entry : node.entries)
    collect(entry.value, path.empty() ? entry.key : path + "." + entry.key, values);
  for (std::size_t i = 0; i < node.items.size(); ++i)
    collect(node.items[i], fmt::format("{}[{}]", path, i), values);
}

/// The sections that are there or not, whatever stands in them: `clearance: {}` is one. Those of
/// lists' entries have keys that must be there.
void collectSections(const YamlNode& root, Values& values) {
  for (const KeyRow& row : keyRows(sceneKeys())) {
    const bool may_be_absent =
        row.spec->type == ValueType::kSection && row.spec->presence == Presence::kOptional;
    const bool is_of_list = row.path.find("[]") != std::string::npos;
    if (may_be_absent && !is_of_list && findGiven(root, row.path)) values[row.path] = "is there";
  }
}

Values valuesOf(const Scene& scene) {
  Values values;
  if (!scene.tree) return values;
  collect(*scene.tree, "", values);
  collectSections(*scene.tree, values);
  values.erase("extends");
  return values;
}

std::map<std::string, double> numbersOf(const Scene& scene) {
  return {scene.numbers.begin(), scene.numbers.end()};
}

/// All that is read of a robot: settings that are laid over it, and its files.
bool haveSameRobot(const Scene& one, const Scene& other) {
  const auto robot = [](const Scene& scene) {
    std::vector<std::string> texts;
    for (const Override& setting : scene.overrides)
      if (setting.key.starts_with("robot.")) texts.push_back(setting.key + "=" + setting.value);
    for (std::size_t i = scene.scene_sources; i < scene.sources.size(); ++i)
      texts.push_back(scene.sources[i].text);
    return texts;
  };
  return robot(one) == robot(other);
}

const GainKey* findGain(const std::string& path) {
  const auto& keys = gainKeys();
  const auto found = std::ranges::find(keys, path, &GainKey::path);
  return found == keys.end() ? nullptr : &*found;
}

/// An optional section above a key that the scene has not: with the key it would begin to exist.
bool makesSection(const Scene& running, const std::string& path) {
  for (const KeyRow& row : keyRows(sceneKeys())) {
    const bool is_above = path.starts_with(row.path + ".");
    if (is_above && row.spec->presence == Presence::kOptional &&
        !findGiven(*running.tree, row.path))
      return true;
  }
  return false;
}

/// The setting of the robot that was laid over it; empty where only its files differ.
std::string robotSetting(const Scene& running, const Scene& changed) {
  for (const Override& setting : changed.overrides) {
    const auto is_same = [&setting](const Override& old) {
      return old.key == setting.key && old.value == setting.value;
    };
    if (setting.key.starts_with("robot.") && std::ranges::none_of(running.overrides, is_same))
      return setting.key;
  }
  return "";
}

[[noreturn]] void refuse(const Scene& running, const Scene& changed, const std::string& key) {
  const char* const expectation = "expected keys that `tactus keys` calls live or free";
  const std::string of_robot = key == "robot" ? robotSetting(running, changed) : "";
  if (!of_robot.empty())
    failAt(beginOf("--set " + of_robot), of_robot, "needs a restart, nothing is changed",
           expectation);
  const bool was = findGiven(*running.tree, key), is = findGiven(*changed.tree, key);
  const char* const problem = was == is ? "needs a restart, nothing is changed"
                              : is      ? "is new and needs a restart, nothing is changed"
                                        : "is gone, which needs a restart, nothing is changed";
  failAt(locate(*changed.tree, key), key, problem, expectation);
}

bool isRaised(const Gains& from, const Gains& to) {
  return to.force.max_null_speed_m_per_s > from.force.max_null_speed_m_per_s ||
         to.force.max_null_speed_rad_per_s > from.force.max_null_speed_rad_per_s ||
         to.task.max_return_speed_m_per_s > from.task.max_return_speed_m_per_s ||
         to.task.max_return_speed_rad_per_s > from.task.max_return_speed_rad_per_s;
}

/// Laws of two spaces bounce on stiff obstacles. Their gains decide, in no simple order, how fast
/// the arm gets there: on the way between two sets it may push several times harder than with
/// either.
bool mayPushHarderOnTheWay(const ControllerConfig& config) {
  return config.force_control && isOfTwoSpaces(config.force_control->variant);
}

bool waitsForFree(const Scene& running, const GainPlan& plan) {
  if (plan.keys.empty()) return false;
  const ControllerConfig& changed = plan.scene.controller;
  const auto isOfFreeSpace = [](const std::string& key) {
    return findGain(key)->spec.context == KeyContext::kFree;
  };
  return std::ranges::any_of(plan.keys, isOfFreeSpace) ||
         isRaised(running.controller.gains, changed.gains) || mayPushHarderOnTheWay(changed);
}

/// From its end, which is what was asked for, so that a refusal names that.
void checkRamp(const Scene& running, const Scene& changed, double least_deg) {
  const Gains& from = running.controller.gains;
  Scene point = changed;
  for (int i = kPointsOfTheRamp; i > 0; --i) {
    point.controller.gains =
        gainsBetween(from, changed.controller.gains, static_cast<double>(i) / kPointsOfTheRamp);
    // Of a product of gains that rise and fall there may be more on the way than at both ends.
    const ControllerConfig& controller = point.controller;
    if (const auto steep = findGainConflict(controller.gains, gainUse(controller), point.period_s))
      failAt(locate(*changed.tree, steep->path), steep->path, steep->problem + " on the way there",
             "expected " + steep->expectation);
    requirePhaseMargin(point, least_deg);
  }
}

}  // namespace

std::vector<std::string> differingKeys(const Scene& one, const Scene& other) {
  const Values a = valuesOf(one), b = valuesOf(other);
  const auto numbers_a = numbersOf(one), numbers_b = numbersOf(other);
  std::vector<std::string> keys;
  const auto isSameNumber = [&](const std::string& key) {
    const auto at_a = numbers_a.find(key), at_b = numbers_b.find(key);
    return at_a != numbers_a.end() && at_b != numbers_b.end() && at_a->second == at_b->second;
  };
  const auto add = [&](const Values& from, const Values& to, bool only_missing) {
    for (const auto& [key, text] : from) {
      const auto found = to.find(key);
      if (found != to.end() && (only_missing || found->second == text)) continue;
      if (!isSameNumber(key)) keys.push_back(key);
    }
  };
  add(a, b, false);
  add(b, a, true);
  std::ranges::sort(keys);
  if (!haveSameRobot(one, other)) keys.push_back("robot");
  return keys;
}

double leastMargin_deg(const Scene& started) {
  return std::min(kMinPhaseMargin_deg, phaseMargin_deg(started));
}

GainPlan planChange(const Scene& running, Scene changed, double least_deg) {
  GainPlan plan{.scene = std::move(changed), .keys = {}};
  plan.keys = differingKeys(running, plan.scene);
  for (const std::string& key : plan.keys) {
    if (!findGain(key) || makesSection(running, key) || makesSection(plan.scene, key))
      refuse(running, plan.scene, key);
  }
  plan.waits_for_free = waitsForFree(running, plan);
  checkRamp(running, plan.scene, least_deg);
  return plan;
}

GainPlan planSettings(const Scene& running, const std::vector<Override>& settings,
                      double least_deg) {
  std::vector<Override> overrides = running.overrides;
  // Each key once, however often it is set.
  std::erase_if(overrides, [&settings](const Override& old) {
    return std::ranges::count(settings, old.key, &Override::key) > 0;
  });
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  return planChange(running, loadScene(running.sources, overrides), least_deg);
}

GainPlan planReload(const Scene& running, const std::vector<Override>& overrides,
                    double least_deg) {
  return planChange(running, loadScene(running.sources.front().path, overrides), least_deg);
}

}  // namespace tactus
