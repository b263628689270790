#include "tactus/run/clearance_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <vector>

#include "tactus/control/nearest_body.h"
#include "tactus/run/contact_report.h"
#include "tactus/scene/clearance_loader.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

NearestBody nearestAtStart(const ControllerConfig& config) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  return nearestBody(BodyDistances(config.chain, *config.clearance), pose);
}

void addOnce(std::vector<std::string>& names, const std::string& name) {
  if (std::ranges::count(names, name) == 0) names.push_back(name);
}

/// A link, and all that it keeps clear of.
struct LinkPairs {
  std::string link;
  std::vector<std::string> others;
};

std::vector<LinkPairs> pairsByLink(const Scene& scene) {
  const ClearanceConfig& config = *scene.controller.clearance;
  const ClearanceNames& names = scene.clearance;
  std::vector<LinkPairs> links;
  const auto add = [&](int capsule, const std::string& other) {
    const std::string link = escaped(names.capsules[capsule]);
    auto found = std::ranges::find(links, link, &LinkPairs::link);
    if (found == links.end()) found = links.insert(links.end(), {link, {}});
    addOnce(found->others, escaped(other));
  };
  for (const CapsulePair& pair : config.pairs) add(pair.capsule, names.capsules[pair.other]);
  for (const WallPair& pair : config.wall_pairs) add(pair.capsule, names.walls[pair.wall]);
  return links;
}

std::vector<std::string> alwaysTouching(const ClearanceNames& names) {
  std::vector<std::string> pairs;
  for (const CapsulePair& pair : names.touching)
    addOnce(pairs, fmt::format("{} and {}", escaped(names.capsules[pair.capsule]),
                               escaped(names.capsules[pair.other])));
  return pairs;
}

struct NamedLinkCapsule {
  std::string link;
  LinkCapsule capsule;
};

std::vector<NamedLinkCapsule> capsulesOf(const Scene& scene) {
  std::vector<NamedLinkCapsule> named;
  for (std::size_t i = 0; i < scene.plant.capsules.size(); ++i)
    named.push_back({scene.capsule_links[i], scene.plant.capsules[i]});
  for (std::size_t i = 0; i < scene.controller.tactile_modules.size(); ++i) {
    const TactileModuleConfig& module = scene.controller.tactile_modules[i];
    named.push_back({scene.module_links[i],
                     {module.link, Vector3::Zero(), Vector3(module.length_m, 0.0, 0.0),
                      module.cover_radius_m}});
  }
  return named;
}

/// In place of an empty list that robot.yaml may have.
Scene withCapsules(const Scene& scene, const std::string& proposed) {
  const std::string_view key = "collision_capsules:\n";
  const std::string list = proposed.substr(proposed.find(key) + key.size());
  const bool has_some = list.starts_with("  - ") || list.find("\n  - ") != std::string::npos;
  if (!has_some || !scene.plant.capsules.empty()) return scene;
  std::vector<Override> overrides = scene.overrides;
  overrides.push_back({"robot.collision_capsules", list});
  return loadScene(scene.sources, overrides, SceneUse::kSimulation);
}

}  // namespace

std::string clearanceText(const Scene& scene) {
  if (!scene.controller.clearance) return "";
  const ClearanceConfig& config = *scene.controller.clearance;
  const NearestBody nearest = nearestAtStart(scene.controller);
  std::string text = textLine(
      "clear",
      fmt::format("by {:g} m of {} pairs of capsules and {} with walls; nearest at the start {}, "
                  "{:.4g} m",
                  config.safe_distance_m, config.pairs.size(), config.wall_pairs.size(),
                  namesOfPair(config, scene.clearance, nearest.index), nearest.distance_m));
  for (const LinkPairs& link : pairsByLink(scene))
    text += textLine("", fmt::format("{} of {}", link.link, fmt::join(link.others, ", ")));
  const std::vector<std::string> touching = alwaysTouching(scene.clearance);
  if (!touching.empty())
    text += textLine("", fmt::format("not of what always touches: {}", fmt::join(touching, ", ")));
  return text;
}

void addClearance(const Scene& scene, Json& json) {
  if (!scene.controller.clearance) return;
  const ClearanceConfig& config = *scene.controller.clearance;
  const NearestBody nearest = nearestAtStart(scene.controller);
  Json links = Json::array();
  for (const LinkPairs& link : pairsByLink(scene))
    links.push_back({{"link", link.link}, {"others", link.others}});
  json["clearance"] = {{"safe_distance_m", config.safe_distance_m},
                       {"pairs", config.pairs.size()},
                       {"wall_pairs", config.wall_pairs.size()},
                       {"nearest_at_start", namesOfPair(config, scene.clearance, nearest.index)},
                       {"nearest_at_start_m", nearest.distance_m},
                       {"links", links},
                       {"always_touching", alwaysTouching(scene.clearance)}};
}

std::string touchingCapsules(const Scene& scene, const std::string& proposed) {
  constexpr double kTouching_m = 1e-6;
  const std::vector<NamedLinkCapsule> named = capsulesOf(withCapsules(scene, proposed));
  ClearanceConfig config;
  for (const NamedLinkCapsule& capsule : named) config.capsules.push_back(capsule.capsule);
  const auto size = static_cast<int>(named.size());
  for (int a = 0; a < size; ++a) {
    for (int b = a + 1; b < size; ++b) {
      const int apart = config.capsules[a].link.joint - config.capsules[b].link.joint;
      if (std::abs(apart) > 1) config.pairs.push_back({a, b});
    }
  }
  const SerialChain& chain = scene.controller.chain;
  const BodyDistances distances(chain, config);
  ChainPose pose;
  chain.computePose(scene.controller.q_start, pose);
  std::string text;
  for (int i = 0; i < distances.size(); ++i) {
    const double distance_m = distances.distance_m(pose, i);
    if (distance_m > kTouching_m) continue;
    text += fmt::format(
        "# {} and {} touch at the start, {:.1f} mm deep: a scene's clearance "
        "refuses that, unless they always do\n",
        escaped(named[config.pairs[i].capsule].link), escaped(named[config.pairs[i].other].link),
        std::max(0.0, -1e3 * distance_m));
  }
  return text;
}

}  // namespace tactus
