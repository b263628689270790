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

double ContactSpring::penetration_m(double force_N) const noexcept {
  auto piece = pieces_.rbegin();
  while (force_N < piece->start_N) ++piece;
  return piece->start_m + (force_N - piece->start_N) / piece->stiffness_N_per_m;
}

Obstacle::Obstacle(const ObstacleConfig& config, double robot_stiffness_N_per_m)
    : config_(config),
      shape_(config),
      way_m_(config.swing.x_m, config.swing.y_m, config.swing.z_m),
      spring_(config, robot_stiffness_N_per_m) {
  if (config.friction_coefficient == 0.0) return;
  const double shear = config.shear_stiffness_N_per_m.value_or(config.stiffness_N_per_m);
  friction_.emplace(config.friction_coefficient, inSeries(shear, robot_stiffness_N_per_m));
}

void Obstacle::moveTo(double t_s) noexcept {
  if (config_.swing.frequency_hz <= 0.0) return;
  swing_share_before_ = swing_share_;
  swing_share_ = swingShare(config_.swing, t_s - config_.appears_s);
}

ObstacleContact Obstacle::touch(const CoverAxis& axis, double t_s, Vector3* slid_m) noexcept {
  ObstacleContact contact;
  if (t_s < config_.appears_s || t_s >= config_.vanishes_s) {
    swing_share_ = 0.0;
    return contact;
  }
  moveTo(t_s);
  const bool slides = slid_m && config_.slide_force_N;
  Vector3 shift_m = swing_share_ * way_m_;
  if (slides) shift_m += *slid_m;
  const Meeting meeting = shape_.meet(axis, shift_m);
  contact.force_N = spring_.force_N(meeting.depth_m);
  if (slides && contact.force_N > *config_.slide_force_N) {
    contact.force_N = *config_.slide_force_N;
    *slid_m -= (meeting.depth_m - spring_.penetration_m(contact.force_N)) * meeting.normal_Base;
  }
  contact.position_m = meeting.position_m;
  contact.force_Base = contact.force_N * meeting.normal_Base;
  return contact;
}

ObstacleFriction Obstacle::rub(const ModuleStep& step, const CoverAxis& axis,
                               const ObstacleContact& contact) noexcept {
  ObstacleFriction friction;
  if (contact.force_N <= 0.0) {
    friction_->release();
    return friction;
  }
  const Vector3 normal = contact.force_Base / contact.force_N;
  const Vector3 p_BaseSurface =
      axis.p_BaseStart + contact.position_m * axis.direction - axis.radius_m * normal;
  const Pose& X = step.X_BaseModule;
  friction.p_ModuleSurface = X.R_AB.transpose() * (p_BaseSurface - X.p_AB);
  const Pose& X_before = step.X_BaseModuleBefore;
  const Vector3 p_BaseBefore = X_before.p_AB + X_before.R_AB * friction.p_ModuleSurface;
  const Vector3 way_m = (swing_share_ - swing_share_before_) * way_m_;
  friction.force_Base =
      friction_->update(p_BaseSurface - p_BaseBefore - way_m, normal, contact.force_N);
  return friction;
}

}  // namespace tactus
