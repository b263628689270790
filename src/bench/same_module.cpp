#include "tactus/bench/same_module.h"

#include <algorithm>
#include <cmath>

#include "tactus/bench/post_placing.h"

namespace tactus {
namespace {

constexpr double kPairRest_s = 20.0;
constexpr double kMinApart = 0.25;  ///< of the cover's length
constexpr double kMinLength_m = 0.15;
constexpr int kTriesEachPath = 40;

SeveralKind pairKind(int i) {
  if (i % 5 == 3) return SeveralKind::kAcross;
  return i % 5 == 4 ? SeveralKind::kBothSides : SeveralKind::kSameSide;
}

/// A bar across the link, above or below it, where it comes to in z.
bool placeAcross(const RunSetup& setup, const std::vector<Pose>& path, std::size_t module,
                 const PostPlace& place, ObstacleConfig& post) {
  const auto k =
      std::min(path.size() - 2,
               static_cast<std::size_t>(place.path_share * static_cast<double>(path.size())));
  const Vector3 u = path[k].R_AB.col(0);
  const Vector3 up = (Vector3::UnitZ() - u.z() * u).normalized();
  const double x_m = place.length_share * setup.controller.tactile_modules[module].length_m;
  const Vector3 p_Base = path[k].p_AB + x_m * u;
  const double way_m = up.dot(path[k + 1].p_AB + x_m * path[k + 1].R_AB.col(0) - p_Base);
  if (way_m == 0.0) return false;
  const double reach_m = setup.plant.modules[module].cover_radius_m + place.gap_m;
  post.line = LineConfig{p_Base + std::copysign(reach_m, way_m) * up, up.cross(u)};
  return true;
}

bool placePair(BenchRandom& draw, const ModulePaths& paths, SeveralCase& drawn) {
  RunSetup& setup = drawn.setup;
  const std::vector<TactileModuleConfig>& modules = setup.controller.tactile_modules;
  const auto module = std::min(
      modules.size() - 1,
      static_cast<std::size_t>(draw.uniform(0.0, 1.0) * static_cast<double>(modules.size())));
  if (modules[module].length_m < kMinLength_m) return false;
  setup.plant.obstacles.clear();
  PostPlace first;
  first.path_share = draw.uniform(0.15, 0.6);
  first.length_share = draw.uniform(0.1, 0.9);
  first.min_speed_share = 0.05;
  PostPlace second = first;
  second.length_share = draw.uniform(0.1, 0.9);
  if (std::abs(second.length_share - first.length_share) < kMinApart) return false;
  if (draw.uniform(0.0, 1.0) < 0.6) second.path_share += draw.uniform(0.0, 0.3);
  second.is_behind = drawn.kind == SeveralKind::kBothSides;
  if (second.is_behind) second.gap_m = draw.uniform(0.002, 0.03);
  ObstacleConfig one, other;
  one.stiffness_N_per_m = draw.logUniform(100.0, 1e6);
  other.stiffness_N_per_m = draw.logUniform(100.0, 1e6);
  if (!placePost(setup, paths[module], module, first, one)) return false;
  const auto& path = paths[module];
  if (drawn.kind == SeveralKind::kAcross ? !placeAcross(setup, path, module, second, other)
                                         : !placePost(setup, path, module, second, other))
    return false;
  setup.plant.obstacles = {one, other};
  return !EndWatch(setup).isOut(setup.controller.q_start, 0.0);
}

}  // namespace

std::vector<SeveralCase> drawSameModule(const RunSetup& base, std::uint64_t seed, int count) {
  BenchRandom draw(seed);
  std::vector<SeveralCase> cases;
  for (int i = 0; i < count; ++i) {
    SeveralCase drawn{pairKind(i), Surroundings::kOpen, 1, withoutLimits(base)};
    drawPath(draw, drawn.setup);
    const ModulePaths paths = freePaths(drawn.setup);
    drawn.setup.duration_s += kPairRest_s;
    drawn.setup.plant.robot_stiffness_N_per_m =
        draw.uniform(0.0, 1.0) < 0.4 ? kNoLimit : draw.logUniform(2e3, 1e5);
    for (int k = 0; k < kTriesEachPath; ++k) {
      if (!placePair(draw, paths, drawn)) continue;
      cases.push_back(std::move(drawn));
      break;
    }
  }
  return cases;
}

}  // namespace tactus
