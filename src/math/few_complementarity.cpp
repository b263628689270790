#include "tactus/math/few_complementarity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "tactus/math/pair.h"

namespace tactus {
namespace {

/// Of an exchange and a solution, and what they cost beside.
constexpr int kFewStepProducts = 2 * FewComplementarity::kMost * FewComplementarity::kMost + 20;

PairMask maskAt(const long long* first) noexcept {
  PairMask mask;
  std::memcpy(&mask, first, sizeof(mask));
  return mask;
}

/// Zero for others.
Pair ofThose(PairMask mask, Pair values) noexcept {
  return std::bit_cast<Pair>(mask & std::bit_cast<PairMask>(values));
}

}  // namespace

FewComplementarity::FewComplementarity(const RowMatrix& K) noexcept
    : K_(K), rows_(static_cast<int>(K.rows())), l_(K.rows()) {
  forget();
}

void FewComplementarity::forget() noexcept {
  size_ = 0;
  held_.fill(0);
  other_.fill(0);
  std::fill_n(l_.data(), kMost, 0.0);
  for (int j = 0; j < rows_; ++j) {
    const double* const from = K_.data() + j * rows_;
    storePair(pairAt(from), &column_[j][0]);
    storePair(pairAt(from + 2), &column_[j][2]);
    other_[j] = ~0LL;
  }
}

/// Of l and y of a row.
void FewComplementarity::exchange(int row) noexcept {
  Column& own = column_[row];
  const double least = held_[row] != 0 ? 0.0 : kLeastPivot * K_(row, row);
  const double inverse = 1.0 / std::max(own[row], least);
  const Pair own_0 = pairAt(&own[0]);
  const Pair own_2 = pairAt(&own[2]);
  for (int j = 0; j < rows_; ++j) {
    if (j == row) continue;
    Column& other = column_[j];
    const double share = other[row] * inverse;
    const Pair shares{share, share};
    storePair(pairAt(&other[0]) - shares * own_0, &other[0]);
    storePair(pairAt(&other[2]) - shares * own_2, &other[2]);
    other[row] = -share;
  }
  const Pair inverses{inverse, inverse};
  storePair(inverses * own_0, &own[0]);
  storePair(inverses * own_2, &own[2]);
  own[row] = inverse;
  size_ += held_[row] != 0 ? -1 : 1;
  held_[row] = ~held_[row];
  other_[row] = ~other_[row];
}

/// l of the rows that are held where they have y = d, and y of the others.
inline FewComplementarity::Column FewComplementarity::respond(const RowVector& d) const noexcept {
  Pair sum_0{0.0, 0.0};
  Pair sum_2{0.0, 0.0};
  for (int j = 0; j < rows_; ++j) {
    if (held_[j] == 0) continue;
    const Pair d_j{d[j], d[j]};
    sum_0 += d_j * pairAt(&column_[j][0]);
    sum_2 += d_j * pairAt(&column_[j][2]);
  }
  return {sum_0[0], sum_0[1], sum_2[0], sum_2[1]};
}

/// All that are held have multipliers then, and no other row lacks anything.
inline bool FewComplementarity::isSolution(const RowVector& d, const Column& found) const noexcept {
  PairMask is_wrong{0, 0};
  for (int i = 0; i < kMost; i += 2) {
    const Pair d_i = pairAt(d.data() + i);
    const Pair has = pairAt(&found[i]);
    const PairMask lacks = ~(d_i - has <= kRowTolerance * (magnitude(d_i) + magnitude(has)));
    is_wrong |= (maskAt(&held_[i]) & ~(has > 0.0)) | (maskAt(&other_[i]) & lacks);
  }
  return !isAny(is_wrong);
}

/// From l towards z as far as no multiplier becomes negative. False if that was not all the way:
/// rows without a multiplier are then let go.
inline bool FewComplementarity::goTo(const Column& z) noexcept {
  double share = 1.0;
  bool is_whole = true;
  for (int i = 0; i < rows_; ++i) {
    if (held_[i] == 0 || z[i] > 0.0) continue;
    is_whole = false;
    share = std::min(share, l_[i] / (l_[i] - z[i]));
  }
  for (int i = 0; i < rows_; ++i) {
    if (held_[i] == 0) continue;
    if (is_whole) {
      l_[i] = z[i];
      continue;
    }
    l_[i] += share * (z[i] - l_[i]);
    if (z[i] <= 0.0 && l_[i] <= kRowTolerance * std::abs(z[i])) l_[i] = 0.0;
    if (!(l_[i] > 0.0)) exchange(i);
  }
  return is_whole;
}

/// The row that lacks most of those that are not held; -1: none.
inline int FewComplementarity::neediest(const RowVector& d, const Column& has) const noexcept {
  int found = -1;
  double most = 0.0;
  for (int i = 0; i < rows_; ++i) {
    const double lack = d[i] - has[i];
    if (held_[i] != 0 || lack <= most) continue;
    if (lack <= kRowTolerance * (std::abs(d[i]) + std::abs(has[i]))) continue;
    most = lack;
    found = i;
  }
  return found;
}

bool FewComplementarity::solve(const RowVector& d, int& products_left) noexcept {
  while (products_left > 0) {
    products_left -= kFewStepProducts;
    const Column found = respond(d);
    if (size_ > 0) {
      if (isSolution(d, found)) {
        for (int i = 0; i < kMost; i += 2)
          storePair(ofThose(maskAt(&held_[i]), pairAt(&found[i])), l_.data() + i);
        return true;
      }
      if (!goTo(found)) continue;
    }
    const int row = neediest(d, found);
    if (row < 0) return true;
    exchange(row);
  }
  return false;
}

}  // namespace tactus
