#include "tactus/math/complementarity.h"

#include <Eigen/Cholesky>
#include <array>

namespace tactus {
namespace {

constexpr double kTolerance = 1e-12;

/// The rows that are held with equality.
struct ActiveRows {
  std::array<int, kMaxRows> index{};
  int size = 0;

  void add(int row) { index[size++] = row; }
  bool has(int row) const {
    for (int i = 0; i < size; ++i)
      if (index[i] == row) return true;
    return false;
  }
  template <typename Predicate>
  void removeIf(const Predicate& isGone) {
    int kept = 0;
    for (int i = 0; i < size; ++i)
      if (!isGone(index[i])) index[kept++] = index[i];
    size = kept;
  }
};

/// z of K z = d, of the active rows alone.
RowVector solveActive(const RowMatrix& K, const RowVector& d, const ActiveRows& active) {
  RowMatrix K_active(active.size, active.size);
  RowVector z(active.size);
  for (int i = 0; i < active.size; ++i) {
    z[i] = d[active.index[i]];
    for (int j = 0; j < active.size; ++j) K_active(i, j) = K(active.index[i], active.index[j]);
  }
  K_active.llt().solveInPlace(z);
  return z;
}

/// The inactive row that lacks most; -1: none.
int neediest(const RowMatrix& K, const RowVector& d, const RowVector& l, const ActiveRows& active) {
  int found = -1;
  double most = 0.0;
  for (int i = 0; i < d.size(); ++i) {
    const double has = K.row(i).dot(l);
    const double lack = d[i] - has;
    if (active.has(i) || lack <= kTolerance * (std::abs(d[i]) + std::abs(has)) || lack <= most)
      continue;
    most = lack;
    found = i;
  }
  return found;
}

/// From l towards z as far as no multiplier becomes negative; false if that was not all the way.
bool goTo(const RowVector& z, ActiveRows& active, RowVector& l) {
  double share = 1.0;
  for (int i = 0; i < active.size; ++i) {
    const double from = l[active.index[i]];
    if (z[i] <= 0.0) share = std::min(share, from / (from - z[i]));
  }
  const bool is_whole = share == 1.0 && (z.array() > 0.0).all();
  for (int i = 0; i < active.size; ++i) {
    double& from = l[active.index[i]];
    from = is_whole ? z[i] : from + share * (z[i] - from);
    if (!is_whole && z[i] <= 0.0 && from <= kTolerance * std::abs(z[i])) from = 0.0;
  }
  return is_whole;
}

}  // namespace

bool solveComplementarity(const RowMatrix& K, const RowVector& d, RowVector& l,
                          int steps) noexcept {
  const auto rows = static_cast<int>(d.size());
  l.setZero(rows);
  ActiveRows active;
  int left = steps * rows;
  for (int row = neediest(K, d, l, active); row >= 0; row = neediest(K, d, l, active)) {
    active.add(row);
    while (true) {
      if (left-- <= 0) return false;
      if (goTo(solveActive(K, d, active), active, l)) break;
      active.removeIf([&l](int i) { return l[i] <= 0.0; });
      if (active.size == 0) break;
    }
  }
  return true;
}

}  // namespace tactus
