#include "tactus/math/tool_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/math/rotation.h"
#include "tactus/math/sin_cos.h"

namespace tactus {
namespace {

/// Of a direction: what is less is rounding, and gets limits that are not zero.
constexpr double kStraight = 1e-6;

bool isAlong(const Vector3& direction, const Vector3& v) {
  return direction.cross(v).norm() <= kStraight * v.norm();
}

/// Whether a motion along a line with v and a can go on within limits, or is only slowed down.
bool keeps(const MotionLimits& limits, const Vector3& v, const Vector3& a) {
  constexpr double kRounding = 1.0 + 1e-9;
  if (a.norm() > limits.max_acceleration * kRounding) return false;
  // The speed along a until a is zero.
  const double peak =
      (a.norm() > 0.0 ? a.normalized().dot(v) : 0.0) + a.squaredNorm() / (2.0 * limits.max_jerk);
  return peak <= std::max(limits.max_speed, v.norm()) * kRounding;
}

MotionLimits scaled(const MotionLimits& limits, double share) {
  return {limits.max_speed * share, limits.max_acceleration * share, limits.max_jerk * share};
}

/// So that a motion from rest to rest takes `stretch` times as long.
MotionLimits slowed(const MotionLimits& limits, double stretch) {
  return {limits.max_speed / stretch, limits.max_acceleration / (stretch * stretch),
          limits.max_jerk / (stretch * stretch * stretch)};
}

/// (1 - cos x) / x^2, (x - sin x) / x^3 and the derivatives of both, each divided by x.
struct TurnTerms {
  double a, b, a_x, b_x;
};

TurnTerms turnTerms(double x) {
  const double square = x * x;
  if (x < 0.05)
    return {0.5 - square / 24.0 + square * square / 720.0,
            1.0 / 6.0 - square / 120.0 + square * square / 5040.0, -1.0 / 12.0 + square / 180.0,
            -1.0 / 60.0 + square / 1260.0};
  double sine, cosine;
  sinCos(&x, 1, &sine, &cosine);
  const double cube = square * x;
  return {(1.0 - cosine) / square, (x - sine) / cube,
          (x * sine - 2.0 * (1.0 - cosine)) / (square * square),
          (x * (1.0 - cosine) - 3.0 * (x - sine)) / (square * cube)};
}

/// The rotation vector of R R_zero^T that is closest to `phi`, which is no longer than pi.
Vector3 nearestTurn(const Matrix3& R, const Matrix3& R_zero, const Vector3& phi) {
  const Vector3 turn = rotationVector(R * R_zero.transpose());
  const double angle = turn.norm();
  if (angle == 0.0) return turn;
  const Vector3 other = turn * (1.0 - 2.0 * std::numbers::pi / angle);
  return (other - phi).squaredNorm() < (turn - phi).squaredNorm() ? other : turn;
}

Matrix3 zeroOf(const ToolMotionPlan& plan) { return Eigen::Map<const Matrix3>(plan.R_BaseZero); }

}  // namespace

bool isValid(const ToolMotionPlan& plan) noexcept {
  const auto isFinite = [](double x) { return std::isfinite(x); };
  const auto isLimit = [](double x) { return std::isfinite(x) && x > 0.0; };
  bool is_valid = plan.kind <= ToolMotionPlan::Kind::kStop && isFinite(plan.start_s);
  for (const AxisState& state : plan.from)
    is_valid &= isFinite(state.p) && isFinite(state.v) && isFinite(state.a);
  for (const MotionLimits& limits : {plan.limits.position, plan.limits.rotation})
    is_valid &=
        isLimit(limits.max_speed) && isLimit(limits.max_acceleration) && isLimit(limits.max_jerk);
  return is_valid && std::ranges::all_of(plan.target, isFinite) &&
         std::ranges::all_of(plan.R_BaseZero, isFinite);
}

ToolMotion::ToolMotion(const Pose& X_BaseTool, std::uint64_t number) noexcept
    : ToolMotion([&] {
        ToolMotionPlan plan;
        plan.number = number;
        for (int i = 0; i < 3; ++i) plan.from[i].p = X_BaseTool.p_AB[i];
        Eigen::Map<Matrix3>(plan.R_BaseZero) = X_BaseTool.R_AB;
        return plan;
      }()) {}

ToolMotion::ToolMotion(const ToolMotionPlan& plan) noexcept : plan_(plan) {
  planAxes(0, plan.limits.position);
  planAxes(3, plan.limits.rotation);
  const double line_s = longest_s(0), turn_s = longest_s(3);
  duration_s_ = std::max(line_s, turn_s);
  if (plan.kind != ToolMotionPlan::Kind::kGo || line_s == turn_s) return;
  const int faster = line_s < turn_s ? 0 : 3;
  const double stretch = duration_s_ / std::min(line_s, turn_s);
  if (!std::isfinite(stretch) || !wayAt(0, plan.start_s).isAtRest() ||
      !wayAt(3, plan.start_s).isAtRest())
    return;
  planAxes(faster, slowed(faster == 0 ? plan.limits.position : plan.limits.rotation, stretch));
  duration_s_ = std::max(longest_s(0), longest_s(3));
}

void ToolMotion::planAxes(int first, const MotionLimits& limits) noexcept {
  using Kind = ToolMotionPlan::Kind;
  Way from;
  Vector3 direction;
  for (int i = 0; i < 3; ++i) {
    const AxisState& state = plan_.from[first + i];
    from.v[i] = state.v;
    from.a[i] = state.a;
    direction[i] = plan_.target[first + i] - state.p;
  }
  if (plan_.kind == Kind::kStop) direction = from.v;
  const double distance = direction.norm();
  if (distance > 0.0) direction /= distance;
  const bool is_straight = distance > 0.0 && isAlong(direction, from.v) &&
                           isAlong(direction, from.a) && keeps(limits, from.v, from.a);
  for (int i = first; i < first + 3; ++i) {
    const double share = is_straight ? std::max(kStraight, std::abs(direction[i - first])) : 1.0;
    const AxisState& state = plan_.from[i];
    if (plan_.kind == Kind::kRest) {
      axes_[i] = AxisMotion(state.p);
    } else if (plan_.kind == Kind::kStop) {
      axes_[i] = AxisMotion::stop(state, scaled(limits, share));
    } else {
      axes_[i] = AxisMotion(state, plan_.target[i], scaled(limits, share));
    }
  }
}

double ToolMotion::longest_s(int first) const noexcept {
  return std::max(
      {axes_[first].duration(), axes_[first + 1].duration(), axes_[first + 2].duration()});
}

ToolMotionPlan ToolMotion::planFrom(double t_s, const ToolMotionLimits& limits) const noexcept {
  ToolMotionPlan plan = plan_;
  plan.number = plan_.number + 1;
  plan.start_s = t_s;
  plan.limits = limits;
  const Way line = wayAt(0, t_s), turn = wayAt(3, t_s);
  for (int i = 0; i < 3; ++i) {
    plan.from[i] = {line.p[i], line.v[i], line.a[i]};
    plan.from[3 + i] = {turn.p[i], turn.v[i], turn.a[i]};
  }
  if (!turn.isAtRest() && turn.p.norm() <= std::numbers::pi) return plan;
  // From here on about one axis; or after half a turn, as a whole one has no rotation vector that
  // is continuous. At the new zero the speed of that is omega, its acceleration alpha.
  const ToolReference from = evaluate(t_s);
  const Vector3 alpha = evaluateAcceleration(t_s).alpha_BaseTool;
  for (int i = 0; i < 3; ++i) plan.from[3 + i] = {0.0, from.omega_BaseTool[i], alpha[i]};
  Eigen::Map<Matrix3>(plan.R_BaseZero) = from.R_BaseTool;
  return plan;
}

ToolMotion ToolMotion::to(double t_s, const Pose& X_BaseTool,
                          const ToolMotionLimits& limits) const noexcept {
  ToolMotionPlan plan = planFrom(t_s, limits);
  plan.kind = ToolMotionPlan::Kind::kGo;
  const Vector3 phi(plan.from[3].p, plan.from[4].p, plan.from[5].p);
  const Vector3 turn = nearestTurn(X_BaseTool.R_AB, zeroOf(plan), phi);
  for (int i = 0; i < 3; ++i) {
    plan.target[i] = X_BaseTool.p_AB[i];
    plan.target[3 + i] = turn[i];
  }
  return ToolMotion(plan);
}

ToolMotion ToolMotion::stop(double t_s, const ToolMotionLimits& limits) const noexcept {
  ToolMotionPlan plan = planFrom(t_s, limits);
  plan.kind = ToolMotionPlan::Kind::kStop;
  return ToolMotion(plan);
}

ToolMotion::Way ToolMotion::wayAt(int first, double t_s) const noexcept {
  // A time that is NaN stays one.
  const double since_s = t_s - plan_.start_s;
  const double t = t_s >= end_s() ? duration_s_ : since_s < 0.0 ? 0.0 : since_s;
  Way way;
  for (int i = 0; i < 3; ++i) {
    const AxisState state = axes_[first + i].at(t);
    way.p[i] = state.p;
    way.v[i] = state.v;
    way.a[i] = state.a;
  }
  return way;
}

/// omega of R = exp(phi) R_zero: phi_dot + a phi x phi_dot + b phi x (phi x phi_dot).
ToolReference ToolMotion::evaluate(double t_s) const noexcept {
  const Way line = wayAt(0, t_s), turn = wayAt(3, t_s);
  ToolReference reference{line.p, line.v, zeroOf(plan_), Vector3::Zero()};
  if (turn.p.isZero(0.0) && turn.isAtRest()) return reference;
  const TurnTerms terms = turnTerms(turn.p.norm());
  const Vector3 across = turn.p.cross(turn.v);
  reference.R_BaseTool = rotationMatrix(turn.p) * zeroOf(plan_);
  reference.omega_BaseTool = turn.v + terms.a * across + terms.b * turn.p.cross(across);
  return reference;
}

ToolAcceleration ToolMotion::evaluateAcceleration(double t_s) const noexcept {
  const Way turn = wayAt(3, t_s);
  const TurnTerms terms = turnTerms(turn.p.norm());
  const Vector3 across = turn.p.cross(turn.v), across_dot = turn.p.cross(turn.a);
  const Vector3 twice = turn.p.cross(across);
  const Vector3 twice_dot = turn.p.cross(across_dot) + turn.v.cross(across);
  const double along = turn.p.dot(turn.v);
  return {wayAt(0, t_s).a, turn.a + terms.a * across_dot + terms.b * twice_dot +
                               along * (terms.a_x * across + terms.b_x * twice)};
}

}  // namespace tactus
