#include "tactus/bench/surroundings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus {
namespace {

constexpr double kStartApart_m = 0.01;  ///< beyond the safe distance

void narrowJoints(BenchRandom& draw, RunSetup& setup) {
  JointLimits& limits = setup.controller.limits;
  const JointVector& q = setup.controller.q_start;
  const int joints = 1 + std::min(2, static_cast<int>(draw.uniform(0.0, 3.0)));
  for (int k = 0; k < joints; ++k) {
    const auto i = std::min<Eigen::Index>(
        q.size() - 1, static_cast<Eigen::Index>(draw.uniform(0.0, static_cast<double>(q.size()))));
    const double left = draw.uniform(0.05, 0.3);
    if (draw.uniform(0.0, 1.0) < 0.5)
      limits.lower[i] = std::max(limits.lower[i], q[i] - left);
    else
      limits.upper[i] = std::min(limits.upper[i], q[i] + left);
  }
}

void putWall(BenchRandom& draw, RunSetup& setup) {
  ClearanceConfig& clearance = *setup.controller.clearance;
  const double direction = draw.uniform(0.0, 2.0 * std::numbers::pi);
  const double apart_m = clearance.safe_distance_m + draw.uniform(2.0 * kStartApart_m, 0.15);
  HalfSpace wall{Vector3::Zero(), Vector3(std::cos(direction), std::sin(direction), 0.0)};
  clearance.walls = {wall};
  clearance.wall_pairs.clear();
  for (int i = 0; i < static_cast<int>(clearance.capsules.size()); ++i)
    if (clearance.capsules[static_cast<std::size_t>(i)].link.joint >= 0)
      clearance.wall_pairs.push_back({i, 0});
  ControllerConfig alone = setup.controller;
  alone.clearance->pairs.clear();
  const double nearest_m =
      ClearanceWatch(alone).left_m(setup.controller.q_start) + clearance.safe_distance_m;
  clearance.walls[0].p_Surface = (nearest_m - apart_m) * wall.normal;
}

}  // namespace

const char* surroundingsName(Surroundings kind) {
  static constexpr const char* kNames[kSurroundings] = {"open", "joint limits", "bodies", "wall"};
  return kNames[static_cast<int>(kind)];
}

ClearanceWatch::ClearanceWatch(const ControllerConfig& config) : chain_(config.chain) {
  if (!config.clearance) return;
  distances_.emplace(config.chain, *config.clearance);
  safe_m_ = config.clearance->safe_distance_m;
}

double ClearanceWatch::left_m(const JointVector& q) {
  if (!distances_) return kNoLimit;
  chain_.computePose(q, pose_);
  double least_m = kNoLimit;
  for (int i = 0; i < distances_->size(); ++i)
    least_m = std::min(least_m, distances_->distance_m(pose_, i));
  return least_m - safe_m_;
}

bool surround(BenchRandom& draw, Surroundings kind, RunSetup& setup) {
  std::optional<ClearanceConfig>& clearance = setup.controller.clearance;
  if (kind == Surroundings::kJointLimits) narrowJoints(draw, setup);
  if (kind == Surroundings::kWall && clearance) putWall(draw, setup);
  if (kind == Surroundings::kOpen || kind == Surroundings::kJointLimits) clearance.reset();
  return ClearanceWatch(setup.controller).left_m(setup.controller.q_start) > kStartApart_m;
}

}  // namespace tactus
