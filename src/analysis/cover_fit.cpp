#include "tactus/analysis/cover_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "tactus/math/butterworth_step.h"

namespace tactus {
namespace {

constexpr double kBlock_s = 1.0;
constexpr double kDrift_s = 10.0;  ///< so that all unknowns are of one size

using Four = Eigen::Vector4d;

/// Mass and centre of (m, m c, ...).
template <typename Unknowns>
Four massAndCenter(const Unknowns& x) {
  return {x[0], x[1] / x[0], x[2] / x[0], x[3] / x[0]};
}

Fitted fitted(double value, double square) { return {value, std::sqrt(square)}; }

}  // namespace

void CoverFit::Normal::add(const Normal& other, double sign) {
  A += sign * other.A;
  b += sign * other.b;
  squares += sign * other.squares;
  samples += sign * other.samples;
  sum += sign * other.sum;
  sum_of_squares += sign * other.sum_of_squares;
}

CoverFit::CoverFit(const ControllerConfig& config, const TactileModuleConfig& module)
    : chain_(config.chain),
      link_(module.link),
      gravity_Base_(config.gravity_Base),
      middle_m_(0.5 * module.length_m),
      filter_cutoff_hz_(module.filter_cutoff_hz) {}

void CoverFit::add(const JointVector& q, const TactileSample& sample, double step_s) {
  follow(q, step_s);
  const bool is_new = sample.sequence != sequence_;
  sequence_ = sample.sequence;
  block_s_ += step_s;
  time_s_ += step_s;
  if (blocks_.empty() || block_s_ >= kBlock_s) {
    blocks_.emplace_back();
    block_s_ = 0.0;
  }
  if (!is_new) return;
  Normal& block = blocks_.back();
  const double w = 1.0 / middle_m_, t = time_s_ / kDrift_s;
  addRow(Unknowns{{G_.y(), 0, 0, 0, 1, 0, 0, 0, t, 0, 0, 0}}, sample.force_y_N, block);
  addRow(Unknowns{{G_.z(), 0, 0, 0, 0, 1, 0, 0, 0, t, 0, 0}}, sample.force_z_N, block);
  addRow(w * Unknowns{{0, -G_.z(), 0, G_.x(), 0, 0, 1, 0, 0, 0, t, 0}}, w * sample.moment_y_Nm,
         block);
  addRow(w * Unknowns{{0, G_.y(), -G_.x(), 0, 0, 0, 0, 1, 0, 0, 0, t}}, w * sample.moment_z_Nm,
         block);
  block.samples += 1.0;
  block.sum += G_;
  block.sum_of_squares += G_.cwiseAbs2();
}

void CoverFit::addRow(const Unknowns& row, double reading, Normal& normal) {
  normal.A += row * row.transpose();
  normal.b += reading * row;
  normal.squares += reading * reading;
}

void CoverFit::follow(const JointVector& q, double step_s) {
  ChainPose pose;
  chain_.computePose(q, pose);
  const Pose X_BaseModule = framePose(pose, link_);
  const Vector3 p_Base = X_BaseModule.p_AB + middle_m_ * X_BaseModule.R_AB.col(0);
  if (poses_ == 0) p_Base_ = p_Base;
  const Vector3 v_Base = (p_Base - p_Base_) / step_s;
  if (poses_ < 2) v_Base_ = v_Base;  // how it moved before is not known
  const Vector3 a_Base = (v_Base - v_Base_) / step_s;
  p_Base_ = p_Base;
  v_Base_ = v_Base;
  const Vector3 G = X_BaseModule.R_AB.transpose() * (gravity_Base_ - a_Base);
  if (poses_ == 0) {
    origin_ = G;
    s0_ = s1_ = s2_ = Vector3::Zero();
  }
  poses_ = std::min(poses_ + 1, 2);
  const double K = std::min(1.0, std::numbers::pi * filter_cutoff_hz_ * step_s);
  butterworthStep(Vector3(G - origin_), K, s0_, s1_, s2_, G_);
  G_ += origin_;
}

/// By least squares; squares: of what is left.
CoverFit::Unknowns CoverFit::solve(const Normal& normal, double& squares) {
  const Unknowns x = normal.A.ldlt().solve(normal.b);
  squares = normal.squares - x.dot(normal.b);
  return x;
}

CoverEstimate CoverFit::estimate() const {
  CoverEstimate estimate;
  const bool has_rest = !blocks_.empty() && block_s_ < 0.5 * kBlock_s;
  const auto used = std::span(blocks_).first(blocks_.size() - (has_rest ? 1 : 0));
  estimate.blocks = static_cast<int>(used.size());
  if (estimate.blocks < kMinBlocks) return estimate;
  Normal all;
  for (const Normal& block : used) all.add(block, 1.0);
  const Vector3 variance = (all.sum_of_squares - all.sum.cwiseAbs2() / all.samples) / all.samples;
  estimate.change_along = std::sqrt(std::max(0.0, variance.x()));
  estimate.change_across = std::sqrt(std::max(0.0, variance.y() + variance.z()));
  double squares = 0.0;
  const Unknowns found = solve(all, squares);
  const Four x = massAndCenter(found);
  const Four drifts =
      Four(1.0, 1.0, 1.0 / middle_m_, 1.0 / middle_m_).cwiseProduct(found.tail<4>());
  estimate.drift_N_per_s = drifts.cwiseAbs().maxCoeff() / kDrift_s;
  estimate.residual_N = std::sqrt(std::max(0.0, squares) / (4.0 * all.samples));
  std::vector<Four> without;
  Four mean = Four::Zero();
  const double count = estimate.blocks;
  for (const Normal& block : used) {
    Normal rest = all;
    rest.add(block, -1.0);
    without.push_back(massAndCenter(solve(rest, squares)));
    mean += without.back() / count;
  }
  Four spread = Four::Zero();
  for (const Four& one : without) spread += (count - 1.0) / count * (one - mean).cwiseAbs2();
  estimate.mass_kg = fitted(x[0], spread[0]);
  for (int i = 0; i < 3; ++i) estimate.center_m[i] = fitted(x[i + 1], spread[i + 1]);
  return estimate;
}

}  // namespace tactus
