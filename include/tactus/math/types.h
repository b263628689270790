#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "tactus/math/pair.h"

/// Fixed-capacity types. A robot has 2 to kMaxJoints moving joints, known when it is loaded; the
/// storage is always that of the largest one, so nothing in the cycle touches the heap.
namespace tactus {

inline constexpr int kMaxJoints = 16;
inline constexpr int kMaxTaskSize = 6;

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// One number a moving joint, base to tip; m for prismatic joints, rad for revolute ones.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;

/// One number a task component, in the order of the task's components; m or rad.
using TaskVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxTaskSize, 1>;

/// result = v, in fewer instructions than Eigen needs where it does not know the size.
inline void assign(const JointVector& v, JointVector& result) noexcept {
  result.resize(v.size());
  std::copy_n(v.data(), v.size(), result.data());
}

/// A task vector that fills its room, zero beyond the task's components: like ScaledVector faster
/// than loops that know the number.
using PaddedTaskVector = Eigen::Matrix<double, kMaxTaskSize, 1>;

inline PaddedTaskVector paddedTask(const TaskVector& v) noexcept {
  PaddedTaskVector result = PaddedTaskVector::Zero();
  for (int i = 0; i < v.size(); ++i) result[i] = v[i];
  return result;
}

/// result = the first `size` components of v; the rest of its room is written, too.
inline void assign(const PaddedTaskVector& v, int size, TaskVector& result) noexcept {
  result.resize(size);
  PaddedTaskVector::Map(result.data()) = v;
}

/// a^T b of vectors with `size` components, added up in the order in which Eigen adds those of
/// TaskVector, which for most tasks is told here without asking for the number.
inline double dot(const PaddedTaskVector& a, const PaddedTaskVector& b, int size) noexcept {
  if (size == 3) return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
  if (size < 3) return a.head(size).dot(b.head(size));
  double even = a[0] * b[0] + a[2] * b[2];
  double odd = a[1] * b[1] + a[3] * b[3];
  if (size == 6) {
    even += a[4] * b[4];
    odd += a[5] * b[5];
  }
  const double sum = even + odd;
  return size == 5 ? sum + a[4] * b[4] : sum;
}

/// Task components by joints; row-major, so that a row (one task component) is contiguous.
using TaskJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                   kMaxTaskSize, kMaxJoints>;

/// A joint vector in W^1/2 coordinates (v^ = W^1/2 v), where the weighted pseudoinverse is a plain
/// one. Zero beyond the robot's joints: at its fixed size every operation is unrolled, which is
/// faster for six joints than loops that know the number.
using ScaledVector = Eigen::Matrix<double, kMaxJoints, 1>;

/// W^-1/2 J^T: a column a task component, each of them a scaled vector.
using ScaledJacobian = Eigen::Matrix<double, kMaxJoints, kMaxTaskSize>;

/// v^ = factor v, component by component, for any expression v of up to kMaxJoints entries.
template <typename Derived>
ScaledVector scaled(const Eigen::MatrixBase<Derived>& v, const ScaledVector& factor) noexcept {
  ScaledVector result = ScaledVector::Zero();
  for (int i = 0; i < v.size(); ++i) result[i] = factor[i] * v[i];
  return result;
}

/// a^T b. Every second pair of joints is added up in a row, and then both rows.
inline double dot(const ScaledVector& a, const ScaledVector& b) noexcept {
  const auto product = [&](int i) { return alignedPairAt(&a[i]) * alignedPairAt(&b[i]); };
  Pair even = product(0);
  Pair odd = product(2);
  for (int i = 4; i < kMaxJoints; i += 4) {
    even += product(i);
    odd += product(i + 2);
  }
  const Pair sums = even + odd;
  return sums[0] + sums[1];
}

/// A rigid pose: maps coordinates in frame B to frame A.
struct Pose {
  Matrix3 R_AB = Matrix3::Identity();
  Vector3 p_AB = Vector3::Zero();  ///< origin of B in A, m
};

inline Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return {X_AB.R_AB * X_BC.R_AB, X_AB.p_AB + X_AB.R_AB * X_BC.p_AB};
}

}  // namespace tactus
