#pragma once

#include <vector>

#include "tactus/math/types.h"

namespace tactus {

/// Where the tool shall be, base frame.
struct ToolReference {
  Vector3 p_BaseTool;  ///< m
  Vector3 v_BaseTool;  ///< m/s
  Matrix3 R_BaseTool;
  Vector3 omega_BaseTool;  ///< rad/s
};

/// How that speeds up, base frame.
struct ToolAcceleration {
  Vector3 a_BaseTool;      ///< m/s^2
  Vector3 alpha_BaseTool;  ///< rad/s^2
};

/// A straight rest-to-rest motion to a pose given relative to the pose at the start of the run:
/// position along a line, orientation about a fixed axis, both on the same time law.
struct Waypoint {
  Vector3 displacement_m = Vector3::Zero();       ///< base frame, from the start position
  Vector3 rotation_vector_rad = Vector3::Zero();  ///< base frame, from the start orientation
  double speed_m_per_s = 0.1;                     ///< cruise speed of the position, > 0
  double angular_speed_rad_per_s = 0.5;           ///< limit of the orientation's speed, > 0
  double ramp_s = 0.5;   ///< length of the sin^2 speed ramps at both ends, > 0
  double pause_s = 0.0;  ///< rest after arrival, >= 0
};

/// No waypoint: hold the start pose. One: a line. More: a polyline with a stop at every corner.
struct TrajectoryConfig {
  double start_s = 0.0;
  std::vector<Waypoint> waypoints;
};

class Trajectory {
 public:
  Trajectory(const TrajectoryConfig& config, const Pose& X_BaseTool_start);

  /// The reference at time t_s since the start of the run; holds before the first and after the
  /// last motion. Speed is continuously differentiable everywhere.
  ToolReference evaluate(double t_s) const noexcept;

  /// d/dt of the velocities of evaluate(): zero but in the ramps, and bounded everywhere.
  ToolAcceleration evaluateAcceleration(double t_s) const noexcept;

  double end_s() const noexcept;

 private:
  struct Segment {
    double start_s, duration_s, ramp_s;
    double cruise_rate_per_s;  ///< path parameter 0..1 a second, between the ramps
    Vector3 p_start, displacement;
    Matrix3 R_start;
    Vector3 rotation_vector;  ///< base frame
    bool turns = false;       ///< else R_start all the way, and rotation_vector is zero
  };

  /// That has begun last; null: none yet.
  const Segment* segmentAt(double t_s) const noexcept;

  Pose X_start_;
  std::vector<Segment> segments_;
};

}  // namespace tactus
