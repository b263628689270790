#include "tactus/sim/obstacle.h"

#include <cmath>
#include <numbers>

#include "tactus/math/sin_cos.h"

namespace tactus {
namespace {

/// -1 to 1. Whole turns are left out first, so that hours of swinging keep their precision.
double swingShare(const Swing& swing, double t_s) noexcept {
  const double turns = swing.frequency_hz * t_s;
  const double angle = 2.0 * std::numbers::pi * (turns - std::floor(turns));
  double sine, cosine;
  sinCos(&angle, 1, &sine, &cosine);
  return sine;
}

}  // namespace

ContactSpring::ContactSpring(const ObstacleConfig& obstacle, double robot_stiffness_N_per_m) {
  const double solid = inSeries(obstacle.stiffness_N_per_m, robot_stiffness_N_per_m);
  double penetration_m = 0.0;
  double force_N = 0.0;
  for (const FoamLayer& layer : obstacle.foam) {
    const double stiffness = inSeries(layer.stiffness_N_per_m, solid);
    pieces_.push_back({stiffness, penetration_m, force_N});
    penetration_m += (layer.until_force_N - force_N) / stiffness;
    force_N = layer.until_force_N;
  }
  pieces_.push_back({solid, penetration_m, force_N});
}

double ContactSpring::force_N(double penetration_m) const noexcept {
  if (penetration_m <= 0.0) return 0.0;
  auto piece = pieces_.rbegin();
  while (penetration_m < piece->start_m) ++piece;  // the first one starts at 0
  return piece->start_N + piece->stiffness_N_per_m * (penetration_m - piece->start_m);
}

ObstacleContact Obstacle::touch(const CoverAxis& axis, double t_s) noexcept {
  ObstacleContact contact;
  if (t_s < config_.appears_s || t_s >= config_.vanishes_s) return contact;
  const double horizontal = std::hypot(axis.direction.x(), axis.direction.y());
  if (horizontal < 1e-9) return contact;  // a vertical link has no horizontal side to push on
  const double h_x = axis.direction.x() / horizontal;
  const double h_y = axis.direction.y() / horizontal;
  double r_x = config_.x_m - axis.p_BaseStart.x();
  double r_y = config_.y_m - axis.p_BaseStart.y();
  if (config_.swing.frequency_hz > 0.0) {
    const double share = swingShare(config_.swing, t_s - config_.appears_s);
    r_x += share * config_.swing.x_m;
    r_y += share * config_.swing.y_m;
  }
  const double left_m = h_x * r_y - h_y * r_x;  // distance to the left of the axis
  contact.position_m = (h_x * r_x + h_y * r_y) / horizontal;
  if (contact.position_m < 0.0 || contact.position_m > axis.length_m) {
    side_ = 0.0;  // it may come back on the other side
    return contact;
  }
  if (side_ == 0.0) side_ = left_m < 0.0 ? -1.0 : 1.0;
  contact.force_N = spring_.force_N(axis.radius_m - side_ * left_m);
  contact.force_Base = contact.force_N * side_ * Vector3(h_y, -h_x, 0.0);
  return contact;
}

}  // namespace tactus
