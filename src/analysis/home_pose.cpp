#include "tactus/analysis/home_pose.h"

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus {
namespace {

constexpr int kHomePoses = 2000;
/// Of a task that the arm controls well: three times where the controller begins to damp.
constexpr double kWellControlled = 3.0 * WeightedPseudoinverse::kDampingThreshold;

/// Where a joint's position is looked for, m or rad, and to which step it is rounded.
struct HomeRange {
  double from, to, step;
};

HomeRange homeRange(double lower, double upper, JointType type) {
  const double reach = type == JointType::kPrismatic ? 0.3 : 1.2;
  const double finest = type == JointType::kPrismatic ? 1e-3 : 1e-2;
  if (!(upper - lower < kNoLimit)) return {-reach, reach, finest};
  const double quarter = 0.25 * (upper - lower);
  const double middle = std::clamp(0.0, lower + quarter, upper - quarter);
  const double step = std::pow(10.0, std::floor(std::log10(quarter / 5.0)));
  return {std::max(lower + quarter, middle - reach), std::min(upper - quarter, middle + reach),
          std::min(finest, step)};
}

/// 53 random bits make up a number in [0, 1), the same on every machine.
double homeChance(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

using Components = std::vector<int>;

double controlOf(const SerialChain& chain, const ChainPose& pose, const Components& components) {
  TaskJacobian J;
  computeTipJacobian(chain, pose, framePosition(pose, chain.tip()), components.data(),
                     static_cast<int>(components.size()), J);
  return smallestSingularValue(J, JointVector::Ones(chain.size()));
}

/// Best first: where several are controlled well, the first is taken.
const std::vector<Components>& possibleTasks() {
  static const std::vector<Components> tasks = {{0, 1, 2}, {0, 1}, {0, 2}, {1, 2}, {0},
                                                {1},       {2},    {3},    {4},    {5}};
  return tasks;
}

std::vector<JointVector> homeCandidates(const SerialChain& chain, const JointLimits& limits) {
  std::mt19937_64 random(1);
  std::vector<JointVector> candidates(kHomePoses, JointVector(chain.size()));
  for (JointVector& q : candidates) {
    for (int i = 0; i < chain.size(); ++i) {
      const HomeRange range = homeRange(limits.lower[i], limits.upper[i], chain.type(i));
      const double chosen = range.from + (range.to - range.from) * homeChance(random);
      q[i] = range.step * std::round(chosen / range.step);
    }
  }
  return candidates;
}

/// The best pose for one task.
HomePose bestHome(const SerialChain& chain, const std::vector<JointVector>& candidates,
                  const Components& components) {
  HomePose best;
  best.smallest_singular_value = -1.0;
  ChainPose pose;
  for (const JointVector& q : candidates) {
    chain.computePose(q, pose);
    const double control = controlOf(chain, pose, components);
    if (control <= best.smallest_singular_value) continue;
    best.smallest_singular_value = control;
    best.q = q;
  }
  best.task.size = static_cast<int>(components.size());
  std::copy(components.begin(), components.end(), best.task.components.begin());
  return best;
}

/// How far and how fast a joint lets a component move, with the others: in its unit, and that per
/// s.
struct Room {
  double way = kNoLimit, speed = kNoLimit;
};

Room roomAlong(const JointLimits& limits, const HomePose& home, const Eigen::VectorXd& dq) {
  constexpr double kShareOfWay = 0.25, kShareOfSpeed = 0.2;
  Room room;
  for (Eigen::Index i = 0; i < dq.size(); ++i) {
    const double rate = std::abs(dq[i]);
    if (rate < 1e-12) continue;
    const double limit = dq[i] > 0.0 ? limits.upper[i] : limits.lower[i];
    room.way = std::min(room.way, kShareOfWay * std::abs(limit - home.q[i]) / rate);
    room.speed = std::min(room.speed, kShareOfSpeed * limits.max_velocity[i] / rate);
  }
  return room;
}

/// To two digits, and never up.
double roundedDown(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return unit * std::floor(value / unit * (1.0 + 1e-9));
}

}  // namespace

HomePose findHome(const SerialChain& chain, const JointLimits& limits) {
  const std::vector<JointVector> candidates = homeCandidates(chain, limits);
  HomePose best;
  for (const Components& components : possibleTasks()) {
    if (static_cast<int>(components.size()) > chain.size()) continue;
    const HomePose home = bestHome(chain, candidates, components);
    if (home.smallest_singular_value > best.smallest_singular_value || best.task.size == 0)
      best = home;
    if (home.smallest_singular_value >= kWellControlled) return home;
  }
  return best;
}

Waypoint findFirstMotion(const SerialChain& chain, const JointLimits& limits,
                         const HomePose& home) {
  ChainPose pose;
  chain.computePose(home.q, pose);
  TaskJacobian J;
  computeTipJacobian(chain, pose, framePosition(pose, chain.tip()), home.task.components.data(),
                     home.task.size, J);
  const Eigen::MatrixXd gram = J * J.transpose();
  const Eigen::MatrixXd inverse = J.transpose() * gram.inverse();
  Waypoint best;
  double best_share = 0.0;
  for (int k = 0; k < home.task.size; ++k) {
    const int component = home.task.components[k];
    const bool turns = component >= 3;
    for (const double sign : {1.0, -1.0}) {
      const Room room = roomAlong(limits, home, sign * inverse.col(k));
      const double way = std::min(turns ? 0.1 : 0.05, room.way);
      const double speed = std::min(turns ? 0.05 : 0.02, room.speed);
      const double share = way * speed * (turns ? 1.0 : 5.0);
      if (share <= best_share) continue;
      best_share = share;
      best = Waypoint{};
      (turns ? best.rotation_vector_rad : best.displacement_m)[component % 3] =
          sign * roundedDown(way);
      (turns ? best.angular_speed_rad_per_s : best.speed_m_per_s) = roundedDown(speed);
    }
  }
  return best;
}

}  // namespace tactus
