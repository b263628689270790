#include "tactus/math/weighted_pseudoinverse.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <type_traits>

#include "tactus/math/pair.h"

namespace tactus {
namespace {

/// A column that loses more than this against its own length when the earlier ones are taken out of
/// it depends on them: what is left is rounding noise, and no direction.
constexpr double kRankTolerance = 1e-14;

constexpr double kThresholdSquared =
    WeightedPseudoinverse::kDampingThreshold * WeightedPseudoinverse::kDampingThreshold;

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  kMaxTaskSize, kMaxTaskSize>;

template <int kPairs>
using Lanes = Eigen::Matrix<double, 2 * kPairs, 1>;

/// Calls work(n) with a number of pairs that holds so many joints and, if there is room, one that
/// is zero: so that sums end at the same zero as over the whole room. The compiler knows n, so that
/// nothing asks which joints there are.
template <typename Work>
[[gnu::always_inline]] inline auto withPairs(int joints, Work work) {
  if (joints < 8) return work(std::integral_constant<int, 4>());
  if (joints < 10) return work(std::integral_constant<int, 5>());
  if (joints < 12) return work(std::integral_constant<int, 6>());
  if (joints < 14) return work(std::integral_constant<int, 7>());
  return work(std::integral_constant<int, kMaxJoints / 2>());
}

/// Sums of products, added up as a tree over the room of all joints: so the result does not depend
/// on how many of them are left out for being zero.
template <int kPairs, int kFirst = 0, int kWidth = kMaxJoints / 2>
Pair productTree(const double* a, const double* b) {
  if constexpr (kWidth == 1) {
    return alignedPairAt(a + 2 * kFirst) * alignedPairAt(b + 2 * kFirst);
  } else {
    const Pair left = productTree<kPairs, kFirst, kWidth / 2>(a, b);
    if constexpr (kFirst + kWidth / 2 >= kPairs)
      return left;
    else
      return left + productTree<kPairs, kFirst + kWidth / 2, kWidth / 2>(a, b);
  }
}

template <int kPairs>
double dotOf(const double* a, const double* b) {
  const Pair sums = productTree<kPairs>(a, b);
  return sums[0] + sums[1];
}

}  // namespace

void WeightedPseudoinverse::factorise(const TaskJacobian& J,
                                      const ScaledVector& inv_sqrt_weights) noexcept {
  ScaledJacobian J_scaled;
  for (int j = 0; j < J.rows(); ++j) J_scaled.col(j) = scaled(J.row(j), inv_sqrt_weights);
  factorise(J_scaled, static_cast<int>(J.cols()), static_cast<int>(J.rows()));
}

void WeightedPseudoinverse::factorise(const ScaledJacobian& J_scaled, int joints, int m) noexcept {
  joints_ = joints;
  m_ = m;
  withPairs(joints, [&](auto pairs) { orthogonalise<pairs>(J_scaled, 0.0); });
  damping_squared_ = 0.0;
  if (!isFarFromSingular()) judgeNearSingular(J_scaled);
}

void WeightedPseudoinverse::judgeNearSingular(const ScaledJacobian& J_scaled) noexcept {
  double longest_squared = 0.0;
  for (int j = 0; j < m_; ++j)
    longest_squared = std::max(longest_squared, J_scaled.col(j).head(joints_).squaredNorm());
  if (hasNoise(longest_squared))
    withPairs(joints_, [&](auto pairs) { orthogonalise<pairs>(J_scaled, longest_squared); });
  chooseDamping();
}

/// A column that is rounding from the start, as of a component that the arm cannot move, counts as
/// a direction beside itself alone, and one that another rounding turns in the next cycle.
bool WeightedPseudoinverse::hasNoise(double longest_squared) const noexcept {
  const double least = kRankTolerance * std::sqrt(longest_squared);
  bool has_noise = false;
  for (int j = 0; j < m_; ++j) has_noise |= R_[j][j] > 0.0 && R_[j][j] <= least;
  return has_noise;
}

/// Modified Gram-Schmidt, each column orthogonalised twice ("twice is enough"): Q is orthonormal to
/// machine precision whatever the condition of J. longest_squared: what is nothing beside a column
/// of this squared length is no direction, either.
template <int kPairs>
[[gnu::always_inline]] inline void WeightedPseudoinverse::orthogonalise(
    const ScaledJacobian& J_scaled, double longest_squared) noexcept {
  for (int j = 0; j < m_; ++j) {
    Lanes<kPairs> column = J_scaled.col(j).head<2 * kPairs>();
    double explained =
        longest_squared;  // and the squared length of what the earlier ones take away
    for (int k = 0; k < j; ++k) {
      R_[k][j] = dotOf<kPairs>(Q_.col(k).data(), column.data());
      column -= R_[k][j] * Q_.col(k).head<2 * kPairs>();
    }
    for (int k = 0; k < j; ++k) {
      const double correction = dotOf<kPairs>(Q_.col(k).data(), column.data());
      R_[k][j] += correction;
      column -= correction * Q_.col(k).head<2 * kPairs>();
      explained += R_[k][j] * R_[k][j];
    }
    const double rest_squared = dotOf<kPairs>(column.data(), column.data());
    const bool independent = rest_squared > kRankTolerance * kRankTolerance * explained;
    R_[j][j] = independent ? std::sqrt(rest_squared) : 0.0;
    inv_diagonal_[j] = independent ? 1.0 / R_[j][j] : 0.0;
    Q_.col(j).head<2 * kPairs>() = inv_diagonal_[j] * column;
  }
}

/// The singular values of R are those of J W^-1/2. 1 / |R^-1|_F is a lower bound of the smallest
/// one that costs next to nothing; only where it can't rule damping out are they computed.
bool WeightedPseudoinverse::isFarFromSingular() const noexcept {
  double inverse_norm_squared = 0.0;
  bool full_rank = true;
  for (int column = 0; column < m_; ++column) {
    double x[kMaxTaskSize];
    full_rank = full_rank && inv_diagonal_[column] > 0.0;
    for (int row = column; row >= 0; --row) {
      double sum = row == column ? 1.0 : 0.0;
      for (int k = row + 1; k <= column; ++k) sum -= R_[row][k] * x[k];
      x[row] = sum * inv_diagonal_[row];
      inverse_norm_squared += x[row] * x[row];
    }
  }
  return full_rank && inverse_norm_squared * kThresholdSquared <= 1.0;
}

void WeightedPseudoinverse::chooseDamping() noexcept {
  SmallMatrix L = SmallMatrix::Zero(m_, m_);  // J W^-1/2 = L Q^T
  for (int row = 0; row < m_; ++row)
    for (int column = row; column < m_; ++column) L(column, row) = R_[row][column];
  const SmallMatrix gram = L.lazyProduct(L.transpose());
  if (!gram.allFinite()) return;  // solve() then yields the non-finite numbers that the gate stops
  const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(gram);
  const double s_squared = std::max(0.0, solver.eigenvalues()[0]);
  if (s_squared >= kThresholdSquared) return;
  const double s_ratio = std::sqrt(s_squared) / kDampingThreshold;
  damping_squared_ = kMaxDamping * kMaxDamping * (1.0 - s_ratio * s_ratio);
  damped_eigenvalues_.head(m_) = solver.eigenvalues().cwiseMax(0.0).array() + damping_squared_;
  eigenvectors_.topLeftCorner(m_, m_) = solver.eigenvectors();
}

PaddedTaskVector WeightedPseudoinverse::solve(const PaddedTaskVector& w) const noexcept {
  PaddedTaskVector y = PaddedTaskVector::Zero();
  if (!damped()) {
    for (int row = 0; row < m_; ++row) {
      double sum = w[row];
      for (int k = 0; k < row; ++k) sum -= R_[k][row] * y[k];
      y[row] = sum * inv_diagonal_[row];
    }
    return y;
  }
  // y = L^T (L L^T + lambda^2 I)^-1 w
  TaskVector z = eigenvectors_.topLeftCorner(m_, m_).transpose().lazyProduct(w.head(m_));
  z.array() /= damped_eigenvalues_.head(m_).array();
  const TaskVector x = eigenvectors_.topLeftCorner(m_, m_).lazyProduct(z);
  for (int row = 0; row < m_; ++row) {
    y[row] = 0.0;
    for (int k = row; k < m_; ++k) y[row] += R_[row][k] * x[k];
  }
  return y;
}

TaskVector WeightedPseudoinverse::taskVelocity(const PaddedTaskVector& y) const noexcept {
  TaskVector w = TaskVector::Zero(m_);
  for (int k = 0; k < m_; ++k)
    for (int row = k; row < m_; ++row) w[row] += R_[k][row] * y[k];
  return w;
}

PaddedTaskVector WeightedPseudoinverse::project(const ScaledVector& v_scaled) const noexcept {
  return withPairs(joints_, [&](auto pairs) {
    PaddedTaskVector y = PaddedTaskVector::Zero();
    for (int j = 0; j < m_; ++j) y[j] = dotOf<pairs>(Q_.col(j).data(), v_scaled.data());
    return y;
  });
}

ScaledVector WeightedPseudoinverse::expand(const PaddedTaskVector& y) const noexcept {
  return withPairs(joints_, [&](auto pairs) {
    constexpr int kLanes = 2 * pairs;
    Lanes<pairs> v = y[0] * Q_.col(0).template head<kLanes>();
    for (int j = 1; j < m_; ++j) v += y[j] * Q_.col(j).template head<kLanes>();
    ScaledVector v_scaled;
    v_scaled.template head<kLanes>() = v;
    v_scaled.template tail<kMaxJoints - kLanes>().setZero();
    return v_scaled;
  });
}

double smallestSingularValue(const TaskJacobian& J, const JointVector& weights) {
  const TaskJacobian scaled = J * weights.cwiseSqrt().cwiseInverse().asDiagonal();
  const SmallMatrix gram = scaled.lazyProduct(scaled.transpose());
  const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(gram, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

}  // namespace tactus
