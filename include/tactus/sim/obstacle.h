#pragma once

#include <optional>
#include <vector>

#include "tactus/sim/bristle_friction.h"
#include "tactus/sim/obstacle_shape.h"

namespace tactus {

/// Stiffness of two springs in series, N/m; one of them may be infinite.
inline double inSeries(double a, double b) { return 1.0 / (1.0 / a + 1.0 / b); }

/// A piecewise linear spring: force over penetration of the cover.
class ContactSpring {
 public:
  /// Every slope of the obstacle is in series with robot_stiffness_N_per_m (infinite: rigid arm).
  ContactSpring(const ObstacleConfig& obstacle, double robot_stiffness_N_per_m);

  double force_N(double penetration_m) const noexcept;
  /// The other way round, for a force > 0.
  double penetration_m(double force_N) const noexcept;

 private:
  struct Piece {
    double stiffness_N_per_m, start_m, start_N;
  };
  std::vector<Piece> pieces_;
};

/// Where a module is, and where it was a step ago: its material slides along the obstacles.
struct ModuleStep {
  Pose X_BaseModule, X_BaseModuleBefore;
};

/// What one obstacle does to the cover.
struct ObstacleContact {
  double force_N = 0.0;
  double position_m = 0.0;               ///< along the axis
  Vector3 force_Base = Vector3::Zero();  ///< on the robot, N
};

/// What its friction adds, where they touch.
struct ObstacleFriction {
  Vector3 force_Base = Vector3::Zero();       ///< on the robot, N
  Vector3 p_ModuleSurface = Vector3::Zero();  ///< where it acts, module frame, m
};

/// A shape with a spring, in its place or swinging around it.
class Obstacle {
 public:
  Obstacle(const ObstacleConfig& config, double robot_stiffness_N_per_m);

  /// slid_m: how far its foot has slid, base frame, one for all covers; null: nothing slides.
  ObstacleContact touch(const CoverAxis& axis, double t_s, Vector3* slid_m = nullptr) noexcept;

  bool hasFriction() const noexcept { return friction_.has_value(); }
  /// After each touch(), with what that returned, if there is friction.
  ObstacleFriction rub(const ModuleStep& step, const CoverAxis& axis,
                       const ObstacleContact& contact) noexcept;

 private:
  void moveTo(double t_s) noexcept;

  ObstacleConfig config_;
  ObstacleShape shape_;
  Vector3 way_m_;  ///< that it swings to each side
  ContactSpring spring_;
  std::optional<BristleFriction> friction_;
  double swing_share_ = 0.0, swing_share_before_ = 0.0;  ///< of its way, now and a step ago
};

}  // namespace tactus
