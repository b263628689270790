#pragma once

#include <array>
#include <vector>

#include "tactus/control/clearance_config.h"
#include "tactus/control/gains.h"

namespace tactus {

inline constexpr int kMaxNearBodies = 12;      ///< that one configuration tells of
inline constexpr int kMaxMovingCapsules = 72;  ///< of an arm

/// A capsule that is near to another one or to a wall. Its height above that is measured along the
/// normal between them, which is taken as fixed to the other: so the lower end is a lower bound of
/// the distance, as long as neither turns much.
struct NearBody {
  int index = 0;            ///< of BodyDistances
  double distance_m = 0.0;  ///< < 0: they overlap
  double share = 0.0;       ///< where it is nearest: 0 its first end, 1 its second
  int ends = 1;             ///< that differ: 1 of a ball, and of a wall, which has a body an end
  std::array<double, 2> height_m{};      ///< of each end
  std::array<ScaledVector, 2> gradient;  ///< dheight/dq, m/m or m/rad, not scaled
};

/// The nearest ones, in no order.
struct NearBodies {
  std::array<NearBody, kMaxNearBodies> body;
  int size = 0;
  double beyond_m = kNoLimit;  ///< all that is not told of is at least as far away
};

/// Distances of the pairs of a ClearanceConfig, then of its wall pairs, in their order.
class BodyDistances {
 public:
  /// Throws std::invalid_argument for more moving capsules than kMaxMovingCapsules, and for pairs
  /// of which nothing moves.
  BodyDistances(const SerialChain& chain, const ClearanceConfig& config);

  int size() const noexcept { return static_cast<int>(pairs_.size() + walls_.size()); }
  double distance_m(const ChainPose& pose, int index) const noexcept;

  /// What is nearer than reach_m.
  void findNear(const ChainPose& pose, double reach_m, NearBodies& near) const noexcept;

 private:
  struct Capsule {
    int joint;  ///< -1: its axis is in the base frame
    Segment axis;
    double radius_m;
  };
  struct Pair {
    int capsule, other;  ///< the first one moves with a later joint
    double bounds_m;     ///< sum of the radii of balls around both
    double radii_m;
  };
  struct Wall {
    int capsule;
    HalfSpace half_space;
  };
  /// Of all capsules in one pose.
  struct Placed {
    std::array<Segment, kMaxMovingCapsules> axis;
    std::array<Vector3, kMaxMovingCapsules> p_Middle;
  };

  static Segment place(const Capsule& capsule, const ChainPose& pose) noexcept;
  void findNearPairs(const ChainPose& pose, double reach_m, const Placed& placed,
                     NearBodies& near) const noexcept;
  void findNearWalls(const ChainPose& pose, double reach_m, const Placed& placed,
                     NearBodies& near) const noexcept;
  void computeGradients(const ChainPose& pose, int joint, int other_joint, const Segment& axis,
                        const Vector3& normal, NearBody& near) const noexcept;

  SerialChain chain_;
  std::vector<Capsule> capsules_;  ///< those that move first
  int moving_ = 0;
  std::vector<Vector3> p_FixedMiddle_;
  std::vector<Pair> pairs_;
  std::vector<Wall> walls_;
};

}  // namespace tactus
