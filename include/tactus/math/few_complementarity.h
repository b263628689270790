#pragma once

#include <array>

#include "tactus/math/complementarity.h"

namespace tactus {

/// What Complementarity solves, of few rows, for less: of these a matrix is kept that tells by one
/// product both the multipliers of the rows that are held and what the others lack. A row that
/// enters or leaves is one exchange (a principal pivot) of it.
class FewComplementarity {
 public:
  static constexpr int kMost = 4;  ///< rows

  /// K must outlive it.
  explicit FewComplementarity(const RowMatrix& K) noexcept;

  /// See Complementarity.
  bool solve(const RowVector& d, int& products_left) noexcept;
  void forget() noexcept;
  const RowVector& l() const noexcept { return l_; }

 private:
  using Column = std::array<double, kMost>;

  void exchange(int row) noexcept;
  Column respond(const RowVector& d) const noexcept;
  bool isSolution(const RowVector& d, const Column& found) const noexcept;
  bool goTo(const Column& z) noexcept;
  int neediest(const RowVector& d, const Column& has) const noexcept;

  const RowMatrix& K_;
  int rows_;
  RowVector l_;
  int size_ = 0;                                           ///< rows that are held
  alignas(16) std::array<long long, kMost> held_, other_;  ///< all bits of a row's; 0: it is not
  /// y = K l, solved for l of the rows that are held: (l_held, y_others) = T (y_held, l_others).
  /// What is in no row is not defined, and concerns none.
  alignas(16) std::array<Column, kMost> column_;
};

}  // namespace tactus
