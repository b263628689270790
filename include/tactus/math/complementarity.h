#pragma once

#include <Eigen/Core>

namespace tactus {

inline constexpr int kMaxRows = 48;  ///< that one motion has to keep

inline constexpr int kStepsEachRow = 3;

using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;
using RowMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxRows>;

/// The linear complementarity problem
///   l >= 0,   K l >= d,   l^T (K l - d) = 0
/// for a symmetric positive definite K: its one solution, with relative errors of about 1e-12 times
/// the condition of K. These are the multipliers of the least squares min 1/2 l^T K l - d^T l,
/// l >= 0, found as by Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23): one
/// factorisation for each row that enters or leaves. False if steps * n of them were not enough; l
/// >= 0 then keeps the rows that it holds.
bool solveComplementarity(const RowMatrix& K, const RowVector& d, RowVector& l,
                          int steps = kStepsEachRow) noexcept;

}  // namespace tactus
