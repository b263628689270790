#pragma once

#include <array>

#include "tactus/math/types.h"

namespace tactus {

/// The weighted pseudoinverse J# = W^-1 J^T (J W^-1 J^T)^-1 of (1) and its null-space projector
/// N = I - J# J, kept as the factorisation W^-1/2 J^T = Q R and never formed.
///
/// All vectors that enter or leave are scaled: with v^ = W^1/2 v for velocities,
///   J# w       = W^-1/2 Q R^-T w
///   N v        = W^-1/2 (I - Q Q^T) v^
/// so one R^-T, one Q^T for each further vector and one Q at the end make up the motion equation.
///
/// Damping: below kDampingThreshold of the smallest singular value s of J W^-1/2 the *task inverse*
/// is damped with lambda^2 = kMaxDamping^2 (1 - (s / kDampingThreshold)^2); above it is exact. The
/// projector always uses the undamped Q: null-space motion stays out of the task in any pose.
class WeightedPseudoinverse {
 public:
  static constexpr double kDampingThreshold = 0.02;
  static constexpr double kMaxDamping = 0.05;

  /// Of the first m columns of W^-1/2 J^T for so many joints, 1 <= m <= 6, m <= joints.
  void factorise(const ScaledJacobian& J_scaled, int joints, int m) noexcept;

  /// J: m x n with 1 <= m <= 6, m <= n; inv_sqrt_weights: the diagonal of W^-1/2, positive for each
  /// joint and zero beyond.
  void factorise(const TaskJacobian& J, const ScaledVector& inv_sqrt_weights) noexcept;

  /// y = R^-T w (damped near singularities): J# w = W^-1/2 Q y.
  PaddedTaskVector solve(const PaddedTaskVector& w) const noexcept;
  PaddedTaskVector solve(const TaskVector& w) const noexcept { return solve(paddedTask(w)); }

  /// R^T y, the task velocity of the joint velocity W^-1/2 Q y.
  TaskVector taskVelocity(const PaddedTaskVector& y) const noexcept;

  /// Q^T v for a scaled joint vector.
  PaddedTaskVector project(const ScaledVector& v_scaled) const noexcept;

  /// Q y, scaled.
  ScaledVector expand(const PaddedTaskVector& y) const noexcept;

  int taskSize() const noexcept { return m_; }
  bool damped() const noexcept { return damping_squared_ > 0.0; }
  double dampingSquared() const noexcept { return damping_squared_; }

 private:
  template <int kPairs>
  void orthogonalise(const ScaledJacobian& J_scaled, double longest_squared) noexcept;
  bool isFarFromSingular() const noexcept;
  [[gnu::noinline]] void judgeNearSingular(const ScaledJacobian& J_scaled) noexcept;
  bool hasNoise(double longest_squared) const noexcept;
  void chooseDamping() noexcept;

  int joints_ = 0;
  int m_ = 0;
  /// Orthonormal columns, of the robot's joints only; zero where J has lost rank.
  Eigen::Matrix<double, kMaxJoints, kMaxTaskSize> Q_;
  double R_[kMaxTaskSize][kMaxTaskSize];  ///< upper triangular, R_[row][column]
  double inv_diagonal_[kMaxTaskSize];     ///< 1 / R_ii, 0 where J has lost rank
  double damping_squared_ = 0.0;
  /// (R^T R + lambda^2 I) as eigenvalues and vectors; only valid while damped().
  Eigen::Matrix<double, kMaxTaskSize, 1> damped_eigenvalues_;
  Eigen::Matrix<double, kMaxTaskSize, kMaxTaskSize> eigenvectors_;
};

/// Of J W^-1/2, for reports: exact to about 1e-8 of the largest one. weights: positive.
double smallestSingularValue(const TaskJacobian& J, const JointVector& weights);

}  // namespace tactus
