#include "tactus/math/weighted_pseudoinverse.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace tactus {
namespace {

/// A column that loses more than this against its own length when the earlier ones are taken out of
/// it depends on them: what is left is rounding noise, and no direction.
constexpr double kRankTolerance = 1e-14;

double dot(const double* a, const double* b, int n) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// a -= factor * b
void subtract(double* a, double factor, const double* b, int n) {
  for (int i = 0; i < n; ++i) a[i] -= factor * b[i];
}

}  // namespace

/// Modified Gram-Schmidt, each column orthogonalised twice ("twice is enough"): Q is orthonormal to
/// machine precision whatever the condition of J.
void WeightedPseudoinverse::factorise(const TaskJacobian& J,
                                      const JointVector& inv_sqrt_weights) noexcept {
  m_ = static_cast<int>(J.rows());
  n_ = static_cast<int>(J.cols());
  for (int j = 0; j < m_; ++j) {
    double* column = Q_[j];
    for (int i = 0; i < n_; ++i) column[i] = inv_sqrt_weights[i] * J(j, i);
    const double length = std::sqrt(dot(column, column, n_));
    for (int k = 0; k < j; ++k) {
      R_[k][j] = dot(Q_[k], column, n_);
      subtract(column, R_[k][j], Q_[k], n_);
    }
    for (int k = 0; k < j; ++k) {
      const double correction = dot(Q_[k], column, n_);
      R_[k][j] += correction;
      subtract(column, correction, Q_[k], n_);
    }
    const double rest = std::sqrt(dot(column, column, n_));
    const bool independent = rest > kRankTolerance * length;
    R_[j][j] = independent ? rest : 0.0;
    inv_diagonal_[j] = independent ? 1.0 / rest : 0.0;
    for (int i = 0; i < n_; ++i) column[i] *= inv_diagonal_[j];
  }
  chooseDamping();
}

/// The singular values of R are those of J W^-1/2. 1 / |R^-1|_F is a lower bound of the smallest
/// one that costs next to nothing; only where it can't rule damping out are they computed.
void WeightedPseudoinverse::chooseDamping() noexcept {
  damping_squared_ = 0.0;
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
  constexpr double kThresholdSquared = kDampingThreshold * kDampingThreshold;
  if (full_rank && inverse_norm_squared * kThresholdSquared <= 1.0) return;

  using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                    kMaxTaskSize, kMaxTaskSize>;
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

TaskVector WeightedPseudoinverse::solve(const TaskVector& w) const noexcept {
  TaskVector y(m_);
  if (!damped()) {
    for (int row = 0; row < m_; ++row) {
      double sum = w[row];
      for (int k = 0; k < row; ++k) sum -= R_[k][row] * y[k];
      y[row] = sum * inv_diagonal_[row];
    }
    return y;
  }
  // y = L^T (L L^T + lambda^2 I)^-1 w
  TaskVector z = eigenvectors_.topLeftCorner(m_, m_).transpose().lazyProduct(w);
  z.array() /= damped_eigenvalues_.head(m_).array();
  const TaskVector x = eigenvectors_.topLeftCorner(m_, m_).lazyProduct(z);
  for (int row = 0; row < m_; ++row) {
    y[row] = 0.0;
    for (int k = row; k < m_; ++k) y[row] += R_[row][k] * x[k];
  }
  return y;
}

TaskVector WeightedPseudoinverse::project(const JointVector& v_scaled) const noexcept {
  TaskVector y(m_);
  for (int j = 0; j < m_; ++j) y[j] = dot(Q_[j], v_scaled.data(), n_);
  return y;
}

void WeightedPseudoinverse::subtractExpanded(const TaskVector& y,
                                             JointVector& v_scaled) const noexcept {
  for (int j = 0; j < m_; ++j) subtract(v_scaled.data(), y[j], Q_[j], n_);
}

}  // namespace tactus
