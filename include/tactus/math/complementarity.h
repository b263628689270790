#pragma once

#include <Eigen/Core>
#include <array>

namespace tactus {

inline constexpr int kMaxRows = 60;  ///< that one motion has to keep

/// Products that the solutions of one set of rows may take together, a bound of their time: some
/// 40 us at 2.6 GHz. Of the drawn sets of 45 rows with friction in docs/gate.md a few of a thousand
/// need more.
inline constexpr int kMostProducts = 100'000;

using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;
using RowMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxRows>;

/// Of the sum of the magnitudes of a row's d and K l: by less it lacks nothing.
inline constexpr double kRowTolerance = 1e-12;
inline constexpr double kLeastPivot = 1e-15;  ///< of K_ii: rounding must not make K indefinite

/// In the room of whole fours, which is worked on at once, what is beyond the rows.
inline void zeroRest(RowVector& v) noexcept {
  for (auto i = v.size(); i % 4 != 0; ++i) v.data()[i] = 0.0;
}

/// Linear complementarity problems
///   l >= 0,   K l >= d,   l^T (K l - d) = 0
/// for one symmetric positive definite K: the one solution of each, with relative errors of about
/// 1e-12 times the condition of K. These are the multipliers of the least squares
/// min 1/2 l^T K l - d^T l, l >= 0, found as by Lawson and Hanson (Solving Least Squares Problems,
/// 1974, chapter 23), from the last solution: one row more of a factorisation for each row that
/// enters, rotations of it for each that leaves.
class Complementarity {
 public:
  /// K must outlive it.
  explicit Complementarity(const RowMatrix& K) noexcept;

  /// Takes what it needs from products_left, beyond zero by one step at most. False if that was not
  /// enough; l >= 0 then keeps the rows that it holds, and that was the last solution.
  bool solve(const RowVector& d, int& products_left) noexcept;

  /// The next solution begins at zero.
  void forget() noexcept;

  /// Zero before the first solution, and in the room of whole fours beyond its rows.
  const RowVector& l() const noexcept { return l_; }

 private:
  void hold(int row) noexcept;
  void release(int i) noexcept;
  void letGo() noexcept;
  void solveHeld(const RowVector& d) noexcept;
  bool goToZ() noexcept;
  bool settle(const RowVector& d) noexcept;
  template <int kPairs>
  void lackOf(int first, const RowVector& d) noexcept;
  int neediest(const RowVector& d) noexcept;

  const RowMatrix& K_;
  int products_left_ = 0;
  RowVector l_;
  int size_ = 0;                                       ///< rows that are held with equality
  int forward_ = 0;                                    ///< of them have y for this d
  std::array<int, kMaxRows> held_;                     ///< they
  std::array<const double*, kMaxRows> column_;         ///< of K, theirs
  std::array<double, kMaxRows> inverse_;               ///< of the diagonal of L
  std::array<double, kMaxRows> lack_;                  ///< d - K l, of all rows
  std::array<double, kMaxRows> y_;                     ///< L y = d
  std::array<double, kMaxRows> z_;                     ///< theirs, if none were to be positive
  std::array<double, kMaxRows*(kMaxRows + 1) / 2> L_;  ///< K = L L^T of them, a row after another
};

}  // namespace tactus
