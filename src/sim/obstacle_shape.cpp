#include "tactus/sim/obstacle_shape.h"

#include <cmath>

namespace tactus {
namespace {

Segment segmentOf(const CoverAxis& axis) noexcept {
  return {axis.p_BaseStart, axis.direction, axis.length_m};
}

}  // namespace

ObstacleShape::Shape ObstacleShape::shapeOf(const ObstacleConfig& config) {
  if (const auto& sphere = config.sphere) return *sphere;
  if (const auto& plane = config.plane)
    return HalfSpace{plane->point_m, plane->normal.normalized()};
  if (const auto& line = config.line)
    return Bar{{line->point_m, line->direction.normalized(), -kNoLimit, kNoLimit}, 0.0};
  if (const auto& post = config.post)
    return Bar{{post->foot_m, post->axis.normalized(), 0.0, post->height_m}, post->radius_m};
  return VerticalLine{config.x_m, config.y_m, 0.0};
}

ObstacleShape::ObstacleShape(const ObstacleConfig& config) : shape_(shapeOf(config)) {}

Meeting ObstacleShape::meet(const CoverAxis& axis, const Vector3& shift_m) noexcept {
  // std::visit might throw.
  if (const auto* sphere = std::get_if<SphereConfig>(&shape_)) return meet(*sphere, axis, shift_m);
  if (const auto* bar = std::get_if<Bar>(&shape_)) return meet(*bar, axis, shift_m);
  if (const auto* half = std::get_if<HalfSpace>(&shape_)) return meet(*half, axis, shift_m);
  auto* line = std::get_if<VerticalLine>(&shape_);
  return line ? meet(*line, axis, shift_m) : Meeting{};
}

Meeting ObstacleShape::meet(VerticalLine& line, const CoverAxis& axis,
                            const Vector3& shift_m) noexcept {
  const double horizontal = std::hypot(axis.direction.x(), axis.direction.y());
  if (horizontal < 1e-9) return {};  // a vertical link has no horizontal side to push on
  const double h_x = axis.direction.x() / horizontal;
  const double h_y = axis.direction.y() / horizontal;
  const double r_x = line.x_m - axis.p_BaseStart.x() + shift_m.x();
  const double r_y = line.y_m - axis.p_BaseStart.y() + shift_m.y();
  const double left_m = h_x * r_y - h_y * r_x;  // distance to the left of the axis
  const double position_m = (h_x * r_x + h_y * r_y) / horizontal;
  if (position_m < 0.0 || position_m > axis.length_m) {
    line.side = 0.0;  // it may come back on the other side
    return {};
  }
  if (line.side == 0.0) line.side = left_m < 0.0 ? -1.0 : 1.0;
  return {axis.radius_m - line.side * left_m, position_m, line.side * Vector3(h_y, -h_x, 0.0)};
}

Meeting ObstacleShape::meet(const SphereConfig& sphere, const CoverAxis& axis,
                            const Vector3& shift_m) noexcept {
  const Vector3 center = sphere.center_m + shift_m;
  return onItsSide(closestPoints(segmentOf(axis), center), axis.radius_m + sphere.radius_m);
}

Meeting ObstacleShape::meet(const Bar& bar, const CoverAxis& axis,
                            const Vector3& shift_m) noexcept {
  Straight shifted = bar.axis;
  shifted.p += shift_m;
  return onItsSide(closestPoints(segmentOf(axis), shifted), axis.radius_m + bar.radius_m);
}

Meeting ObstacleShape::meet(const HalfSpace& half_space, const CoverAxis& axis,
                            const Vector3& shift_m) noexcept {
  const ClosestPoints closest =
      closestPoints(segmentOf(axis), HalfSpace{half_space.p_Surface + shift_m, half_space.normal});
  return {axis.radius_m - closest.distance_m, closest.position_m, closest.normal};
}

/// The normal turns about smoothly but where the axis goes through the obstacle's.
Meeting ObstacleShape::onItsSide(const ClosestPoints& closest, double reach_m) noexcept {
  if (!closest.is_beside) {
    normal_before_.reset();  // it may come back on the other side
    return {reach_m - closest.distance_m, closest.position_m, closest.normal};
  }
  const double side = normal_before_ && normal_before_->dot(closest.normal) < 0.0 ? -1.0 : 1.0;
  normal_before_ = side * closest.normal;
  return {reach_m - side * closest.distance_m, closest.position_m, *normal_before_};
}

}  // namespace tactus
