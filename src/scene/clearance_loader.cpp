#include "tactus/scene/clearance_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactus/control/nearest_body.h"
#include "tactus/scene/capsule_loader.h"
#include "tactus/scene/drawn_configurations.h"

namespace tactus {
namespace {

constexpr const char* kSection = "clearance";

/// A clearance on its way from its section.
struct ClearanceLoading {
  const YamlNode& root;
  const ClearanceSection& section;
  const LoadedRobot& robot;
  const JointVector& q_start;
  NamedClearance named{};
  int links = 0;  ///< so many of the capsules are the robot's

  [[noreturn]] void fail(const std::string& key, const std::string& problem,
                         const std::string& expectation) const {
    const std::string path = key.empty() ? kSection : fmt::format("{}.{}", kSection, key);
    failAt(locate(root, path), path, problem, "expected " + expectation);
  }
  const LinkCapsule& capsule(int i) const { return named.config.capsules[i]; }
  const std::string& name(int i) const { return named.names.capsules[i]; }
};

void loadDistances(ClearanceLoading& l) {
  const ClearanceSection& section = l.section;
  const double safe_m = section.safe_distance_m;
  if (section.influence_distance_m <= safe_m)
    l.fail("influence_distance_m",
           fmt::format("{} m is not above safe_distance_m", section.influence_distance_m),
           fmt::format("more than {}", safe_m));
  if (section.avoid && section.avoid->distance_m <= safe_m)
    l.fail("avoid.distance_m",
           fmt::format("{} m is not above safe_distance_m", section.avoid->distance_m),
           fmt::format("more than {}", safe_m));
  l.named.config.safe_distance_m = safe_m;
  l.named.config.influence_distance_m = section.influence_distance_m;
  l.named.config.avoid = section.avoid;
}

void loadLinks(ClearanceLoading& l) {
  NamedCapsules links = loadCapsules(l.robot, false);
  if (links.capsules.empty())
    l.fail("", "the robot has no collision_capsules",
           "some in robot.yaml: tactus check --capsules proposes them");
  l.named.config.capsules = std::move(links.capsules);
  l.named.names.capsules = std::move(links.links);
  l.links = static_cast<int>(l.named.config.capsules.size());
}

void checkExcluded(const ClearanceLoading& l) {
  std::vector<std::string> known = l.named.names.capsules;
  for (std::size_t i = 0; i < l.section.exclude.size(); ++i) {
    const ExcludedPair& pair = l.section.exclude[i];
    for (const auto& [key, link] : {std::pair{"link", pair.link}, std::pair{"other", pair.other}}) {
      if (std::ranges::count(known, link) > 0) continue;
      const std::string nearest = nearestWord(link, known);
      l.fail(fmt::format("exclude[{}].{}", i, key), inQuotes(link) + " has no collision_capsules",
             nearest.empty() ? "a link that has some" : "perhaps " + inQuotes(nearest));
    }
    if (pair.link == pair.other)
      l.fail(fmt::format("exclude[{}].other", i),
             inQuotes(pair.link) + " with itself, of which no pair is made", "another link");
  }
}

bool isExcluded(const ClearanceLoading& l, int a, int b) {
  return std::ranges::any_of(l.section.exclude, [&](const ExcludedPair& pair) {
    return (pair.link == l.name(a) && pair.other == l.name(b)) ||
           (pair.link == l.name(b) && pair.other == l.name(a));
  });
}

void addSelfCollision(ClearanceLoading& l) {
  for (int a = 0; l.section.self_collision && a < l.links; ++a) {
    for (int b = a + 1; b < l.links; ++b) {
      const int apart = std::abs(l.capsule(a).link.joint - l.capsule(b).link.joint);
      if (apart > 1 && !isExcluded(l, a, b)) l.named.config.pairs.push_back({a, b});
    }
  }
}

void checkDirection(const ClearanceLoading& l, const std::string& key, const Vector3& direction) {
  constexpr double kMinLength = 1e-6;
  if (direction.norm() < kMinLength) l.fail(key, "has no length", "a vector other than zero");
}

/// Of which links this body is kept clear.
std::vector<int> keptLinks(const ClearanceLoading& l, const KeepOutSection& body,
                           const std::string& key) {
  const int tool = l.robot.chain.tip.joint;
  std::vector<int> kept;
  for (int i = 0; i < l.links; ++i) {
    const int joint = l.capsule(i).link.joint;
    if (joint >= 0 && (body.links == KeptLinks::kAll || joint == tool)) kept.push_back(i);
  }
  if (kept.empty() && body.links == KeptLinks::kTool)
    l.fail(key + ".for", "no collision capsule moves with the last joint",
           "all, or a capsule there");
  return kept;
}

void addWall(ClearanceLoading& l, const PlaneConfig& plane, const std::string& key,
             const std::vector<int>& kept) {
  checkDirection(l, key + ".plane.normal", plane.normal);
  const auto wall = static_cast<int>(l.named.config.walls.size());
  l.named.config.walls.push_back({plane.point_m, plane.normal.normalized()});
  l.named.names.walls.push_back(key);
  for (const int capsule : kept) l.named.config.wall_pairs.push_back({capsule, wall});
}

LinkCapsule bodyOf(const ClearanceLoading& l, const KeepOutSection& body, const std::string& key) {
  if (body.sphere) return {{}, body.sphere->center_m, body.sphere->center_m, body.sphere->radius_m};
  checkDirection(l, key + ".post.axis", body.post->axis);
  return {{},
          body.post->foot_m,
          body.post->foot_m + body.post->height_m * body.post->axis.normalized(),
          body.post->radius_m};
}

void addKeepOut(ClearanceLoading& l) {
  for (std::size_t i = 0; i < l.section.keep_out.size(); ++i) {
    const KeepOutSection& body = l.section.keep_out[i];
    const std::string key = fmt::format("keep_out[{}]", i);
    const int shapes =
        int(body.plane.has_value()) + int(body.sphere.has_value()) + int(body.post.has_value());
    if (shapes != 1)
      l.fail(key, shapes == 0 ? "no shape" : "more than one shape", "one of plane, sphere, post");
    const std::vector<int> kept = keptLinks(l, body, key);
    if (body.plane) {
      addWall(l, *body.plane, key, kept);
      continue;
    }
    const auto other = static_cast<int>(l.named.config.capsules.size());
    l.named.config.capsules.push_back(bodyOf(l, body, key));
    l.named.names.capsules.push_back(key);
    for (const int capsule : kept) l.named.config.pairs.push_back({capsule, other});
  }
}

struct DistanceRange {
  double from_m = kNoLimit, to_m = -kNoLimit;
};

std::vector<DistanceRange> rangesOf(const ClearanceLoading& l, const BodyDistances& distances) {
  const SerialChain chain(l.robot.chain.joints, l.robot.chain.tip);
  std::vector<DistanceRange> ranges(distances.size());
  ChainPose pose;
  for (int number = 0; number <= kDrawnConfigurations; ++number) {
    const JointVector q =
        number == 0 ? l.q_start : drawnConfiguration(chain, l.robot.chain.limits, number);
    chain.computePose(q, pose);
    for (int i = 0; i < distances.size(); ++i) {
      const double distance_m = distances.distance_m(pose, i);
      ranges[i].from_m = std::min(ranges[i].from_m, distance_m);
      ranges[i].to_m = std::max(ranges[i].to_m, distance_m);
    }
  }
  return ranges;
}

/// What no motion can change: links that always touch, bodies at the same distance everywhere.
void leaveOutUnchanging(ClearanceLoading& l) {
  constexpr double kSame_m = 1e-9;
  ClearanceConfig& config = l.named.config;
  const SerialChain chain(l.robot.chain.joints, l.robot.chain.tip);
  const std::vector<DistanceRange> ranges = rangesOf(l, BodyDistances(chain, config));
  const std::vector<CapsulePair> pairs = std::exchange(config.pairs, {});
  const std::vector<WallPair> wall_pairs = std::exchange(config.wall_pairs, {});
  const auto changes = [&](std::size_t i) { return ranges[i].to_m - ranges[i].from_m > kSame_m; };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool is_link = pairs[i].other < l.links;
    const bool always_touch = is_link && ranges[i].to_m < config.safe_distance_m;
    if (always_touch) l.named.names.touching.push_back(pairs[i]);
    if (!always_touch && changes(i)) config.pairs.push_back(pairs[i]);
  }
  for (std::size_t i = 0; i < wall_pairs.size(); ++i)
    if (changes(pairs.size() + i)) config.wall_pairs.push_back(wall_pairs[i]);
}

std::string apartText(double distance_m) {
  return distance_m < 0.0 ? fmt::format("overlap by {:.4g} m", -distance_m)
                          : fmt::format("are {:.4g} m apart", distance_m);
}

/// Of the pair that is least so.
void checkClearAtStart(const ClearanceLoading& l) {
  const ClearanceConfig& config = l.named.config;
  const SerialChain chain(l.robot.chain.joints, l.robot.chain.tip);
  ChainPose pose;
  chain.computePose(l.q_start, pose);
  const NearestBody nearest = nearestBody(BodyDistances(chain, config), pose);
  if (nearest.distance_m >= config.safe_distance_m) return;
  l.fail("safe_distance_m",
         fmt::format("{} {} at the start", namesOfPair(config, l.named.names, nearest.index),
                     apartText(nearest.distance_m)),
         fmt::format("at least {} m, or a pair of links under exclude", config.safe_distance_m));
}

}  // namespace

std::string namesOfPair(const ClearanceConfig& config, const ClearanceNames& names, int index) {
  const auto pairs = static_cast<int>(config.pairs.size());
  const auto text = [](const std::string& a, const std::string& b) {
    return escaped(a) + " and " + escaped(b);
  };
  if (index < pairs) {
    const CapsulePair& pair = config.pairs[index];
    return text(names.capsules[pair.capsule], names.capsules[pair.other]);
  }
  const WallPair& pair = config.wall_pairs[index - pairs];
  return text(names.capsules[pair.capsule], names.walls[pair.wall]);
}

std::optional<NamedClearance> loadClearance(const YamlNode& root, const SceneConfig& scene,
                                            const LoadedRobot& robot, const JointVector& q_start) {
  if (!scene.clearance) return std::nullopt;
  ClearanceLoading l{root, *scene.clearance, robot, q_start};
  loadDistances(l);
  loadLinks(l);
  checkExcluded(l);
  addSelfCollision(l);
  addKeepOut(l);
  leaveOutUnchanging(l);
  if (l.named.config.pairs.empty() && l.named.config.wall_pairs.empty())
    l.fail("", "there is nothing to keep clear of",
           "keep_out, or links that are no neighbours with self_collision");
  checkClearAtStart(l);
  return std::move(l.named);
}

}  // namespace tactus
