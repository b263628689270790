#include "tactus/sim/velocity_loop.h"

#include <cmath>
#include <numbers>

namespace tactus {
namespace {

/// exp(A h) of A = [0, 1; -w^2, -2 d w]: by Cayley-Hamilton exp(-d w h) (C I + S (A + d w I)) with
/// C = cos(w_d h), S = sin(w_d h) / w_d, w_d^2 = w^2 (1 - d^2); hyperbolic beyond d = 1.
Eigen::Matrix2d stepMatrix(double w, double d, double h) {
  const double square = w * w * (1.0 - d * d);
  const double w_d = std::sqrt(std::abs(square));
  double C = 1.0, S = h;
  if (w_d * h > 1e-9) {
    C = square > 0.0 ? std::cos(w_d * h) : std::cosh(w_d * h);
    S = (square > 0.0 ? std::sin(w_d * h) : std::sinh(w_d * h)) / w_d;
  }
  Eigen::Matrix2d result;
  result << C + S * d * w, S, -S * w * w, C - S * d * w;
  return std::exp(-d * w * h) * result;
}

}  // namespace

VelocityLoop::VelocityLoop(const VelocityLoopConfig& config, const JointVector& q, double step_s)
    : step_(stepMatrix(2.0 * std::numbers::pi * config.bandwidth_hz, config.damping_ratio, step_s)),
      velocity_(JointVector::Zero(q.size())) {}

void VelocityLoop::update(const JointVector& q_d, JointVector& q) noexcept {
  const JointVector lag = q - q_d;
  q = q_d + step_(0, 0) * lag + step_(0, 1) * velocity_;
  velocity_ = step_(1, 0) * lag + step_(1, 1) * velocity_;
}

}  // namespace tactus
