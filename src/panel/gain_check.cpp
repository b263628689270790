#include "tactus/panel/gain_check.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "tactus/scene/gain_keys.h"
#include "tactus/scene/gain_plan.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

constexpr std::size_t kMaxValues = 100;

std::vector<Override> settingsOf(const Json& values) {
  if (!values.is_object() || values.size() > kMaxValues)
    throw InputError("values: expected an object of keys and texts");
  std::vector<Override> settings;
  for (const auto& [key, value] : values.items()) {
    if (!value.is_string())
      throw InputError(fmt::format("{}: no text, expected a number as typed", inQuotes(key)));
    settings.push_back({key, value.get<std::string>()});
  }
  return settings;
}

/// Settings that lead from a scene to gains that a daemon has shown.
std::vector<Override> settingsTo(const Json& gains, const Scene& scene) {
  std::vector<Override> settings;
  for (const GainKey& key : gainKeys()) {
    const Json& shown = gains.at(key.path);
    const double value = shown.is_number() ? shown.get<double>() : kNoLimit;
    if (gainAt(scene.controller.gains, key.offset) == value) continue;
    settings.push_back({key.path, shown.is_number() ? shown.dump() : "~"});
  }
  return settings;
}

Scene withSettings(const Scene& scene, const std::vector<Override>& settings) {
  std::vector<Override> overrides = scene.overrides;
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  return loadScene(scene.sources, overrides);
}

void addMargins(const Scene& scene, Json& answer) {
  answer["margin_deg"] = finiteOrNull(phaseMargin_deg(scene));
  const std::optional<StabilityReport> report = checkStability(scene);
  if (report) answer["warnings"] = report->warnings;
}

}  // namespace

void GainCheck::load(const std::optional<RunStart>& start, const Json& shown) {
  std::string wanted = shown.at("scene").get<std::string>() + shown.at("ordered").dump();
  if (start) {
    for (const SourceFile& source : start->sources) wanted += source.text;
    for (const Override& setting : start->overrides) wanted += setting.key + "=" + setting.value;
  }
  if (running_ && wanted == loaded_) return;
  running_.reset();
  const Scene started = start ? loadScene(start->sources, start->overrides)
                              : loadScene(shown.at("scene").get<std::string>(), {});
  least_deg_ = leastMargin_deg(started);
  running_ = withSettings(started, settingsTo(shown.at("ordered"), started));
  running_deg_ = phaseMargin_deg(*running_);
  loaded_ = std::move(wanted);
}

Json GainCheck::check(const std::optional<RunStart>& start, const Json& shown, const Json& values) {
  const std::vector<Override> settings = settingsOf(values);
  load(start, shown);
  Json answer = {{"refused", ""},
                 {"margin_deg", nullptr},
                 {"running_deg", finiteOrNull(running_deg_)},
                 {"least_deg", finiteOrNull(least_deg_)},
                 {"warnings", Json::array()},
                 {"waits_for_free", false}};
  try {
    if (settings.empty()) {
      addMargins(*running_, answer);
    } else {
      const GainPlan plan = planSettings(*running_, settings, least_deg_);
      answer["waits_for_free"] = plan.waits_for_free;
      addMargins(plan.scene, answer);
    }
    return answer;
  } catch (const InputError& error) {
    answer["refused"] = error.what();
  }
  try {
    answer["margin_deg"] = finiteOrNull(phaseMargin_deg(withSettings(*running_, settings)));
  } catch (const InputError&) {  // no scene: it has no margin
  }
  return answer;
}

}  // namespace tactus
