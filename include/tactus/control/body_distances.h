#pragma once

#include <array>
#include <vector>

#include "tactus/control/clearance_config.h"
#include "tactus/control/gains.h"

namespace tactus {

inline constexpr int kMaxNearBodies = 12;      ///< that one configuration tells of
inline constexpr int kMaxMovingCapsules = 72;  ///< of an arm
inline constexpr int kMaxCapsules = 136;       ///< with those that are fixed

/// A capsule that is near to another one, or an end of a capsule near to a wall.
struct NearBody {
  int index;          ///< of BodyDistances
  double distance_m;  ///< < 0: they overlap
  Vector3 normal;     ///< from the other to it, base frame
  Vector3 p_Body;     ///< the point of its axis that is nearest
};

/// Bodies that are nearly parallel are near all along: at both ends of the stretch where one is
/// beside the other, more than at the nearest point, which goes from end to end within no motion.
struct NearStretch {
  double share;  ///< of the ends; 0 from some 11 degrees on, 1: parallel, between smooth
  std::array<NearBody, 2> end;
};

/// Those joints alone, from the first one to the one before the end, change a distance.
struct MovingJoints {
  int begin, end;
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
  /// Throws std::invalid_argument for more capsules than there may be, and for pairs of which
  /// nothing moves.
  BodyDistances(const SerialChain& chain, const ClearanceConfig& config);

  int size() const noexcept { return static_cast<int>(pairs_.size() + walls_.size()); }
  double distance_m(const ChainPose& pose, int index) const noexcept;

  /// What is nearer than reach_m.
  void findNear(const ChainPose& pose, double reach_m, NearBodies& near) const noexcept;

  MovingJoints movingJoints(const NearBody& near) const noexcept;

  /// Of a wall, both of whose ends are near bodies already: a share of 0.
  NearStretch stretch(const ChainPose& pose, const NearBody& near) const noexcept;

  /// Of its distance, m/m or m/rad, not scaled.
  ScaledVector gradient(const ChainPose& pose, const NearBody& near) const noexcept;

  /// To first order in the joints' step time_s velocity from this pose, at least what is left of a
  /// distance: that along the normal, taken as fixed to the other, of the end that is lower then.
  double leftAfter_m(const ChainPose& pose, const NearBody& near, double time_s,
                     const JointVector& velocity) const noexcept;

 private:
  struct Capsule {
    int joint;  ///< -1: its axis is in the base frame
    Segment axis;
    Vector3 p_Middle;  ///< of the axis
    double radius_m;
  };
  struct CapsulesApart {
    int capsule, other;  ///< the first one moves with a later joint
    double radii_m;
  };
  /// Two that follow each other, as one instruction takes both. After an odd one comes one that is
  /// never near.
  struct BallsApart {
    int capsule[2], other[2];
    alignas(16) double radii_m[2];  ///< sum of the radii of balls around both
  };
  struct CapsuleAtWall {
    int capsule;
    HalfSpace half_space;
  };
  /// A vector with each component in both halves of a pair.
  struct TwiceInPairs {
    alignas(16) double xx[2], yy[2], zz[2];
  };
  /// All capsules in one pose, as far as they move.
  struct Placed {
    std::array<double, kMaxCapsules> x_Middle, y_Middle, z_Middle;
    std::array<Segment, kMaxMovingCapsules> axis;
  };

  static Segment place(const Capsule& capsule, const ChainPose& pose) noexcept;
  void placeAll(const ChainPose& pose, Placed& placed) const noexcept;
  void tellOfPair(double reach_m, const Placed& placed, int index, NearBodies& near) const noexcept;
  void tellOfWall(double reach_m, const Placed& placed, int index, NearBodies& near) const noexcept;

  SerialChain chain_;
  std::vector<Capsule> capsules_;  ///< those that move first
  int moving_ = 0;
  std::vector<TwiceInPairs> directions_, starts_;  ///< of the axes of those
  std::vector<CapsulesApart> pairs_;
  std::vector<BallsApart> balls_;  ///< of two pairs each
  std::vector<CapsuleAtWall> walls_;
};

}  // namespace tactus
