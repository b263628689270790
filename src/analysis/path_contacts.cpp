#include "tactus/analysis/path_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tactus/analysis/cover_geometry.h"
#include "tactus/control/controller.h"
#include "tactus/sim/link_contacts.h"

namespace tactus {
namespace {

/// With obstacles that push with 1 N/m: their forces are penetrations.
PlantConfig withUnitSprings(PlantConfig plant) {
  plant.robot_stiffness_N_per_m = kNoLimit;
  for (ObstacleConfig& obstacle : plant.obstacles) {
    obstacle.stiffness_N_per_m = 1.0;
    obstacle.foam.clear();
    obstacle.friction_coefficient = 0.0;
  }
  return plant;
}

/// A cover among obstacles with unit springs.
class FollowedCover {
 public:
  FollowedCover(int index, const TactileModuleConfig& module, double radius_m,
                const PlantConfig& plant)
      : index_(index), module_(module), radius_m_(radius_m) {
    for (const ObstacleConfig& obstacle : plant.obstacles)
      obstacles_.emplace_back(obstacle, plant.robot_stiffness_N_per_m);
    depth_m_.resize(obstacles_.size());
  }

  void moveTo(const ChainPose& pose, const JointVector& q, double t_s, double period_s,
              PathContacts& contacts) {
    const CoverEnds ends = coverEnds(pose, module_);
    if (has_moved_) measureSpeed(ends, q, t_s, period_s, contacts.fastest[index_]);
    ends_ = ends;
    touch(q, t_s, period_s, contacts);
    has_moved_ = true;
  }

 private:
  void measureSpeed(const CoverEnds& ends, const JointVector& q, double t_s, double period_s,
                    FastestCover& fastest) const {
    const std::array<Vector3, 2> now{ends.p_BaseStart, ends.p_BaseEnd};
    const std::array<Vector3, 2> before{ends_.p_BaseStart, ends_.p_BaseEnd};
    for (int end = 0; end < 2; ++end) {
      const Vector3 way = now[end] - before[end];
      const double speed = way.norm() / period_s;
      if (!(speed > fastest.speed_m_per_s)) continue;
      fastest = {speed, t_s, index_, q, now[end], way.normalized()};
    }
  }

  /// The speed of a touch is known a cycle later.
  void touch(const JointVector& q, double t_s, double period_s, PathContacts& contacts) {
    const Vector3 way = ends_.p_BaseEnd - ends_.p_BaseStart;
    const CoverAxis axis{ends_.p_BaseStart, way.normalized(), module_.length_m, radius_m_};
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      const ObstacleContact contact = obstacles_[i].touch(axis, t_s);
      const double depth_m = contact.force_N;
      std::optional<PathTouch>& first = contacts.touches[i];
      if (depth_m > 0.0 && !first) {
        first = PathTouch{.module = index_,
                          .t_s = t_s,
                          .depth_m = depth_m,
                          .q = q,
                          .p_Base = axis.p_BaseStart + contact.position_m * axis.direction,
                          .normal_Base = contact.force_Base.normalized()};
      } else if (first && first->module == index_ && t_s < first->t_s + 1.5 * period_s) {
        first->speed_m_per_s = std::max(0.0, (depth_m - depth_m_[i]) / period_s);
      }
      if (first && first->module == index_) first->deepest_m = std::max(first->deepest_m, depth_m);
      depth_m_[i] = depth_m;
    }
  }

  int index_;
  TactileModuleConfig module_;
  double radius_m_;
  std::vector<Obstacle> obstacles_;
  std::vector<double> depth_m_;  ///< a cycle ago
  CoverEnds ends_;               ///< a cycle ago
  bool has_moved_ = false;
};

/// Adds what the capsules touch in a cycle.
void noteCapsules(const LinkContacts& links, double t_s, std::vector<CapsuleTouch>& touches) {
  for (int i = 0; i < links.capsules(); ++i) {
    for (int k = 0; k < links.obstacles(); ++k) {
      const double depth_m = links.force_N(i, k);
      if (depth_m <= 0.0) continue;
      const auto known = std::ranges::find_if(
          touches, [&](const CapsuleTouch& t) { return t.capsule == i && t.obstacle == k; });
      if (known == touches.end()) {
        touches.push_back({i, k, t_s, depth_m, depth_m});
      } else {
        known->deepest_m = std::max(known->deepest_m, depth_m);
      }
    }
  }
}

}  // namespace

ControllerConfig undisturbed(ControllerConfig config) {
  config.gains.task.wait_beyond_m = config.gains.task.wait_beyond_rad = kNoLimit;
  config.tactile_modules.clear();
  config.force_control.reset();
  return config;
}

PathContacts followPath(const ControllerConfig& config, const PlantConfig& plant, double period_s,
                        double duration_s) {
  const PlantConfig soft = withUnitSprings(plant);
  const SerialChain& arm = plant.chain ? *plant.chain : config.chain;
  PathContacts contacts;
  contacts.touches.resize(plant.obstacles.size());
  contacts.fastest.resize(config.tactile_modules.size());
  std::vector<FollowedCover> covers;
  for (std::size_t i = 0; i < config.tactile_modules.size(); ++i)
    covers.emplace_back(static_cast<int>(i), config.tactile_modules[i],
                        plant.modules[i].cover_radius_m, soft);
  const ControllerConfig alone = undisturbed(config);
  const Controller controller(alone);
  ControllerState state = controller.initialState();
  controller.begin(state);
  ControllerOutput output;
  ChainPose pose;
  arm.computePose(state.q_desired, pose);
  LinkContacts links(soft, pose);
  ScaledVector torque = ScaledVector::Zero();
  const double cycles = std::ceil(duration_s / period_s);
  contacts.is_complete = cycles <= kMaxFollowedCycles;
  const auto last = std::llround(std::min(cycles, kMaxFollowedCycles));
  for (long long cycle = 0; cycle < last; ++cycle) {
    const double t_s = static_cast<double>(cycle) * period_s;
    arm.computePose(state.q_desired, pose);
    for (FollowedCover& cover : covers)
      cover.moveTo(pose, state.q_desired, t_s, period_s, contacts);
    links.touch(arm, pose, t_s, torque);
    noteCapsules(links, t_s, contacts.unsensed);
    controller.update(RobotInput{}, alone.gains, t_s, period_s, state, output);
  }
  return contacts;
}

}  // namespace tactus
