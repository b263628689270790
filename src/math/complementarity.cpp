#include "tactus/math/complementarity.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/pair.h"

namespace tactus {
namespace {

/// As many as one contact with friction has are solved by plain sums and quotients; with more,
/// whose solution takes most of the time, by pairs and products.
constexpr int kFew = 4;
/// What a step costs beside its products, counted as such.
constexpr int kStepProducts = 20;

/// Where a row of a triangle begins.
constexpr int rowAt(int i) noexcept { return i * (i + 1) / 2; }

/// The last ones by themselves: a pair of numbers that have only just been stored one by one waits
/// until they have reached memory.
double sumOfProducts(const double* a, const double* b, int size) noexcept {
  Pair sums{0.0, 0.0};
  int i = 0;
  if (size > kFew)
    for (; i + 4 <= size; i += 2) sums += pairAt(a + i) * pairAt(b + i);
  double sum = sums[0] + sums[1];
  for (; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

/// a -= factor b
void subtract(double factor, const double* b, int size, double* a) noexcept {
  const Pair factors{factor, factor};
  int i = 0;
  for (; i + 2 <= size; i += 2) storePair(pairAt(a + i) - factors * pairAt(b + i), a + i);
  if (i < size) a[i] -= factor * b[i];
}

}  // namespace

Complementarity::Complementarity(const RowMatrix& K) noexcept
    : K_(K), l_(RowVector::Zero(K.rows())) {
  zeroRest(l_);
}

/// L of K = L L^T gets one row more.
void Complementarity::hold(int row) noexcept {
  products_left_ -= size_ * size_ / 2;
  double* const l = L_.data() + rowAt(size_);
  const double* const K_row = K_.data() + row * K_.rows();
  const int few = std::min(size_, kFew);
  for (int j = 0; j < few; ++j) {
    const double* const other = L_.data() + rowAt(j);
    l[j] = (K_row[held_[j]] - sumOfProducts(l, other, j)) / other[j];
  }
  for (int j = few; j < size_; ++j)
    l[j] = (K_row[held_[j]] - sumOfProducts(l, L_.data() + rowAt(j), j)) * inverse_[j];
  const double K_ii = K_row[row];
  l[size_] = std::sqrt(std::max(K_ii - sumOfProducts(l, l, size_), kLeastPivot * K_ii));
  inverse_[size_] = 1.0 / l[size_];
  column_[size_] = K_row;
  held_[size_++] = row;
}

/// A row less, by rotations of two columns each: L Q of those that stay is a triangle again, and
/// Q^T y its forward solution.
void Complementarity::release(int i) noexcept {
  std::array<double, kMaxRows> cosine, sine;
  products_left_ -= 2 * (size_ - i) * (size_ - i);
  --size_;
  const auto rotate = [&](const double* from, int end, double* to) {
    double carried = from[i];
    for (int j = i; j < end; ++j) {
      const double next = from[j + 1];
      to[j] = cosine[j] * carried + sine[j] * next;
      carried = cosine[j] * next - sine[j] * carried;
    }
    return carried;
  };
  for (int k = i; k < size_; ++k) {
    const double* const from = L_.data() + rowAt(k + 1);
    double* const to = L_.data() + rowAt(k);
    std::copy_n(from, i, to);
    const double carried = rotate(from, k, to);
    to[k] = std::sqrt(carried * carried + from[k + 1] * from[k + 1]);
    inverse_[k] = 1.0 / to[k];
    cosine[k] = carried * inverse_[k];
    sine[k] = from[k + 1] * inverse_[k];
    held_[k] = held_[k + 1];
    column_[k] = column_[k + 1];
  }
  rotate(y_.data(), size_, y_.data());
  forward_ = size_;
}

/// Those without a multiplier. Of few, what is left is factored anew: one contact with friction
/// moves to the bit as it always did.
void Complementarity::letGo() noexcept {
  const int before = size_;
  if (before > kFew) {
    for (int i = before - 1; i >= 0; --i)
      if (!(l_[held_[i]] > 0.0)) release(i);
    return;
  }
  size_ = 0;
  while (size_ < before && l_[held_[size_]] > 0.0) ++size_;
  forward_ = std::min(forward_, size_);
  for (int i = size_; i < before; ++i)
    if (l_[held_[i]] > 0.0) hold(held_[i]);
}

/// z of K z = d, of the rows that are held alone.
inline void Complementarity::solveHeld(const RowVector& d) noexcept {
  for (int i = forward_; i < size_; ++i) {
    const double* const l = L_.data() + rowAt(i);
    double left = d[held_[i]];
    if (i < kFew) {
      for (int j = 0; j < i; ++j) left -= l[j] * y_[j];
      y_[i] = left / l[i];
    } else {
      y_[i] = (left - sumOfProducts(l, y_.data(), i)) * inverse_[i];
    }
  }
  forward_ = size_;
  for (int i = 0; i < size_; i += 2) storePair(pairAt(y_.data() + i), z_.data() + i);
  for (int i = size_ - 1; i >= kFew; --i) {
    z_[i] *= inverse_[i];
    subtract(z_[i], L_.data() + rowAt(i), i, z_.data());
  }
  const int few = std::min(size_, kFew);
  for (int i = few - 1; i >= 0; --i) {
    double sum = 0.0;
    for (int j = i + 1; j < few; ++j) sum += L_[rowAt(j) + i] * z_[j];
    z_[i] = (z_[i] - sum) / L_[rowAt(i) + i];
  }
}

/// From l towards z as far as no multiplier becomes negative; false if that was not all the way.
inline bool Complementarity::goToZ() noexcept {
  double share = 1.0;
  bool is_whole = true;
  for (int i = 0; i < size_; ++i) {
    if (z_[i] > 0.0) continue;
    is_whole = false;
    const double from = l_[held_[i]];
    share = std::min(share, from / (from - z_[i]));
  }
  if (is_whole) {
    for (int i = 0; i < size_; ++i) l_[held_[i]] = z_[i];
    return true;
  }
  for (int i = 0; i < size_; ++i) {
    double& from = l_[held_[i]];
    from += share * (z_[i] - from);
    if (z_[i] <= 0.0 && from <= kRowTolerance * std::abs(z_[i])) from = 0.0;
  }
  return false;
}

/// Until all that are held have multipliers.
inline bool Complementarity::settle(const RowVector& d) noexcept {
  while (size_ > 0) {
    if (products_left_ <= 0) return false;
    products_left_ -= size_ * size_ + kStepProducts;
    solveHeld(d);
    if (goToZ()) return true;
    letGo();
  }
  return true;
}

/// d - K l of 2 kPairs rows; z is l of what is held.
template <int kPairs>
inline void Complementarity::lackOf(int first, const RowVector& d) noexcept {
  std::array<Pair, kPairs> has{};
  for (int j = 0; j < size_; ++j) {
    const Pair z{z_[j], z_[j]};
    for (int k = 0; k < kPairs; ++k) has[k] += z * pairAt(column_[j] + first + 2 * k);
  }
  for (int i = first, k = 0; k < kPairs; i += 2, ++k)
    storePair(pairAt(d.data() + i) - has[k], lack_.data() + i);
}

/// The row that lacks most of those that are not held; -1: none.
inline int Complementarity::neediest(const RowVector& d) noexcept {
  const auto rows = static_cast<int>(l_.size());
  products_left_ -= rows * size_;
  if (rows == 1) {
    lack_[0] = d[0];  // as it is not held
  } else if (rows < 4) {
    lackOf<1>(0, d);
    lackOf<1>(rows - 2, d);
  } else {
    int i = 0;
    for (; i + 8 <= rows; i += 8) lackOf<4>(i, d);
    for (; i < rows; i += 4) lackOf<2>(std::min(i, rows - 4), d);
  }
  int found = -1;
  double most = 0.0;
  for (int i = 0; i < rows; ++i) {
    const double lack = lack_[i];
    if (lack <= most || l_[i] > 0.0) continue;
    if (lack <= kRowTolerance * (std::abs(d[i]) + std::abs(d[i] - lack))) continue;
    most = lack;
    found = i;
  }
  return found;
}

void Complementarity::forget() noexcept {
  l_.setZero();
  size_ = 0;
}

bool Complementarity::solve(const RowVector& d, int& products_left) noexcept {
  products_left_ = products_left;
  forward_ = 0;
  bool is_solved = false;
  while (!is_solved && settle(d)) {
    const int row = size_ < static_cast<int>(l_.size()) ? neediest(d) : -1;
    is_solved = row < 0;
    if (!is_solved) hold(row);
  }
  products_left = products_left_;
  return is_solved;
}

}  // namespace tactus
