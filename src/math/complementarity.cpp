#include "tactus/math/complementarity.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kTolerance = 1e-12;
constexpr double kLeastPivot = 1e-15;  ///< of K_ii: rounding must not make K indefinite

/// Where a row of a triangle begins.
constexpr int rowAt(int i) noexcept { return i * (i + 1) / 2; }

double sumOfProducts(const double* a, const double* b, int size) noexcept {
  double sum = 0.0;
  for (int i = 0; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

Complementarity::Complementarity(const RowMatrix& K) noexcept
    : K_(K), l_(RowVector::Zero(K.rows())) {}

/// L of K = L L^T gets one row more.
void Complementarity::hold(int row) noexcept {
  double* const l = L_.data() + rowAt(size_);
  for (int j = 0; j < size_; ++j) {
    const double* const other = L_.data() + rowAt(j);
    l[j] = (K_(row, held_[j]) - sumOfProducts(l, other, j)) / other[j];
  }
  const double K_ii = K_(row, row);
  l[size_] = std::sqrt(std::max(K_ii - sumOfProducts(l, l, size_), kLeastPivot * K_ii));
  held_[size_++] = row;
}

/// Those without a multiplier. What was held before the first of them stays as it is.
void Complementarity::letGo() noexcept {
  const int before = size_;
  size_ = 0;
  while (size_ < before && l_[held_[size_]] > 0.0) ++size_;
  forward_ = std::min(forward_, size_);
  for (int i = size_; i < before; ++i)
    if (l_[held_[i]] > 0.0) hold(held_[i]);
}

/// z of K z = d, of the rows that are held alone.
void Complementarity::solveHeld(const RowVector& d) noexcept {
  const int size = size_;
  for (int i = forward_; i < size; ++i) {
    const double* const l = L_.data() + rowAt(i);
    double left = d[held_[i]];
    for (int j = 0; j < i; ++j) left -= l[j] * y_[j];
    y_[i] = left / l[i];
  }
  forward_ = size;
  for (int i = size - 1; i >= 0; --i) {
    double sum = 0.0;
    for (int j = i + 1; j < size; ++j) sum += L_[rowAt(j) + i] * z_[j];
    z_[i] = (y_[i] - sum) / L_[rowAt(i) + i];
  }
}

/// From l towards z as far as no multiplier becomes negative; false if that was not all the way.
bool Complementarity::goToZ() noexcept {
  double share = 1.0;
  bool is_whole = true;
  for (int i = 0; i < size_; ++i) {
    if (z_[i] > 0.0) continue;
    is_whole = false;
    const double from = l_[held_[i]];
    share = std::min(share, from / (from - z_[i]));
  }
  for (int i = 0; i < size_; ++i) {
    double& from = l_[held_[i]];
    from = is_whole ? z_[i] : from + share * (z_[i] - from);
    if (!is_whole && z_[i] <= 0.0 && from <= kTolerance * std::abs(z_[i])) from = 0.0;
  }
  return is_whole;
}

/// Until all that are held have multipliers.
bool Complementarity::settle(const RowVector& d, int& steps) noexcept {
  while (size_ > 0) {
    if (steps-- <= 0) return false;
    solveHeld(d);
    if (goToZ()) return true;
    letGo();
  }
  return true;
}

/// The row that lacks most of those that are not held; -1: none.
inline int Complementarity::neediest(const RowVector& d) const noexcept {
  int found = -1;
  double most = 0.0;
  const auto rows = static_cast<int>(l_.size());
  const double* const l = l_.data();
  const double* K_row = K_.data();
  for (int i = 0; i < rows; ++i, K_row += rows) {
    if (l[i] > 0.0) continue;
    double has = 0.0;
    for (int j = 0; j < size_; ++j) has += K_row[held_[j]] * l[held_[j]];
    const double lack = d[i] - has;
    if (lack <= most || lack <= kTolerance * (std::abs(d[i]) + std::abs(has))) continue;
    most = lack;
    found = i;
  }
  return found;
}

void Complementarity::forget() noexcept {
  l_.setZero();
  size_ = 0;
}

bool Complementarity::solve(const RowVector& d, int steps_each_row) noexcept {
  int steps = steps_each_row * static_cast<int>(l_.size());
  forward_ = 0;
  if (!settle(d, steps)) return false;
  while (size_ < static_cast<int>(l_.size())) {
    const int row = neediest(d);
    if (row < 0) break;
    hold(row);
    if (!settle(d, steps)) return false;
  }
  return true;
}

}  // namespace tactus
