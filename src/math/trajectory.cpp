#include "tactus/math/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/math/rotation.h"
#include "tactus/math/sin_cos.h"

namespace tactus {
namespace {

struct PathPoint {
  double s, s_dot;
};

/// Distance of a sin^2 speed ramp of length T from 0 to 1, and its speed, x into the ramp.
PathPoint ramp(double x, double T) {
  const double phase = std::numbers::pi * x / T;
  double sine, cosine;
  sinCos(&phase, 1, &sine, &cosine);
  return {0.5 * x - T / (2.0 * std::numbers::pi) * sine, 0.5 - 0.5 * cosine};
}

/// Path parameter 0..1 of a rest-to-rest motion at time t into it.
PathPoint timeLaw(double t, double duration, double T, double rate) {
  if (t < T) {
    const auto [s, speed] = ramp(t, T);
    return {rate * s, rate * speed};
  }
  if (t < duration - T) return {rate * (0.5 * T + (t - T)), rate};
  const auto [s, speed] = ramp(duration - t, T);
  return {1.0 - rate * s, rate * speed};
}

/// d^2/dt^2 of timeLaw().
double timeLawAcceleration(double t, double duration, double T, double rate) {
  const double into_ramp = t < T ? t : duration - t;
  if (into_ramp >= T || t >= duration) return 0.0;
  const double phase = std::numbers::pi * into_ramp / T;
  double sine, cosine;
  sinCos(&phase, 1, &sine, &cosine);
  return (t < T ? rate : -rate) * 0.5 * std::numbers::pi / T * sine;
}

}  // namespace

Trajectory::Trajectory(const TrajectoryConfig& config, const Pose& X_BaseTool_start)
    : X_start_(X_BaseTool_start) {
  double time_s = config.start_s;
  Vector3 p = X_start_.p_AB;
  Matrix3 R = X_start_.R_AB;
  Vector3 rotation_vector = Vector3::Zero();
  for (const Waypoint& waypoint : config.waypoints) {
    Segment segment;
    segment.start_s = time_s;
    segment.p_start = p;
    segment.R_start = R;
    p = X_start_.p_AB + waypoint.displacement_m;
    segment.displacement = p - segment.p_start;
    segment.rotation_vector = Vector3::Zero();
    if (waypoint.rotation_vector_rad != rotation_vector) {
      rotation_vector = waypoint.rotation_vector_rad;
      R = rotationMatrix(rotation_vector) * X_start_.R_AB;
      segment.rotation_vector = rotationVector(R * segment.R_start.transpose());
      segment.turns = true;
    }
    // The slower of the two motions sets the pace; short paths never reach their cruise speed.
    const double cruise_s =
        std::max(segment.displacement.norm() / waypoint.speed_m_per_s,
                 segment.rotation_vector.norm() / waypoint.angular_speed_rad_per_s);
    segment.ramp_s = waypoint.ramp_s;
    segment.cruise_rate_per_s = 1.0 / std::max(cruise_s, waypoint.ramp_s);
    segment.duration_s = std::max(cruise_s, waypoint.ramp_s) + waypoint.ramp_s;
    segments_.push_back(segment);
    time_s += segment.duration_s + waypoint.pause_s;
  }
}

double Trajectory::end_s() const noexcept {
  return segments_.empty() ? 0.0 : segments_.back().start_s + segments_.back().duration_s;
}

const Trajectory::Segment* Trajectory::segmentAt(double t_s) const noexcept {
  const auto next =
      std::upper_bound(segments_.begin(), segments_.end(), t_s,
                       [](double t, const Segment& segment) { return t < segment.start_s; });
  return next == segments_.begin() ? nullptr : &*std::prev(next);
}

ToolAcceleration Trajectory::evaluateAcceleration(double t_s) const noexcept {
  const Segment* const segment = segmentAt(t_s);
  if (!segment) return {Vector3::Zero(), Vector3::Zero()};
  const double s_dd = timeLawAcceleration(t_s - segment->start_s, segment->duration_s,
                                          segment->ramp_s, segment->cruise_rate_per_s);
  return {s_dd * segment->displacement, s_dd * segment->rotation_vector};
}

ToolReference Trajectory::evaluate(double t_s) const noexcept {
  const Segment* const at = segmentAt(t_s);
  if (!at) return {X_start_.p_AB, Vector3::Zero(), X_start_.R_AB, Vector3::Zero()};
  const Segment& segment = *at;
  const double t = t_s - segment.start_s;
  // A time that is no number must not look like one after the end.
  const PathPoint path = t >= segment.duration_s ? PathPoint{1.0, 0.0}
                                                 : timeLaw(t, segment.duration_s, segment.ramp_s,
                                                           segment.cruise_rate_per_s);
  ToolReference reference{segment.p_start + path.s * segment.displacement,
                          path.s_dot * segment.displacement, segment.R_start, Vector3::Zero()};
  if (segment.turns) {
    reference.R_BaseTool =
        rotationMatrix(path.s * segment.rotation_vector).lazyProduct(segment.R_start);
    reference.omega_BaseTool = path.s_dot * segment.rotation_vector;
  }
  return reference;
}

}  // namespace tactus
