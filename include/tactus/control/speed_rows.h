#pragma once

#include <array>

#include "tactus/control/gains.h"
#include "tactus/control/motion.h"
#include "tactus/math/complementarity.h"

namespace tactus {

/// a^T q_dot >= -v_max: the arm shall not go faster along -a.
struct SpeedRow {
  ScaledVector a_scaled;    ///< W^-1/2 a
  PaddedTaskVector a_task;  ///< Q^T W^-1/2 a
  double v_max_m_per_s;
  double damping_N_s_per_m;  ///< D = dF/dv: force that costs one m/s too much, > 0
  double presence;           ///< p: from 0 where a row begins to exist, so that it makes no step
};

/// a^T q_dot
inline double speedAlong(const SpeedRow& row, int task_size, const Motion& motion) noexcept {
  return dot(row.a_scaled, motion.v_scaled) + dot(row.a_task, motion.y, task_size);
}

/// So many of them, without memory of more.
struct SpeedRows {
  std::array<SpeedRow, kMaxRows> row;
  int size = 0;
  /// Solved by Complementarity, and without the last repetition's solution: one contact has the
  /// motion, to the last bit, that it had before there were more.
  bool is_of_one_contact = false;
};

/// What a change of the motion costs: M = (task J#J + null_space N) W^-1.
struct RowSpace {
  double task, null_space;
  double max_yielding;  ///< y: of delta_i, as a share of K_ii
  double proximal;      ///< rho: of delta_i in any case, likewise
};

/// Yielding in proportion to forces would be most of what a null space that hardly moves the
/// contact can do; the other level has that. What three rows or more make ill-conditioned, though
/// no two of them oppose each other, moves by rho as little as helps, where exact solutions would
/// be as large as sensitive. A row by itself is kept to rho^4.
inline constexpr RowSpace kNullSpaceAlone{0.0, 1.0, 0.1, 0.03};
/// The null space, being cheap, does most, and stopping all is within reach.
inline constexpr RowSpace kBothSpaces{1.0, 30.0, 0.01, 1e-6};

// clang-format off: equations
/// The least change of a motion q_1 that keeps all rows:
///   q_dot = q_1 + M A^T l
///   l >= 0,   K l >= -v_max - A q_1,  complementary,       K = A M A^T
/// Rows that oppose each other (K_ij < 0) may exclude each other. They yield by slack_i = delta_i
/// l_i with delta_i in proportion to 1 / D_i, which is an equilibrium of forces; rows without
/// opponents are exact. From l = 0 four times, or until nothing changes,
///   l <- LCP(K + diag(delta), d + delta l),
///   delta_i = s delta_0 / D_i min(1, sum_j o_ij) + rho K_ii
///   o_ij = p_i p_j min(0, K_ij)^2 / (K_ii K_jj)
/// with delta_0 = 1.5 N s m, s <= 1 the largest for which s delta_0 / D_i min(1, ..) <= y K_ii in
/// all rows, for four repetitions to find what can be kept beside a row that does not yield, and
/// K_ii at least max(1e-3 |W^-1/2 a_i|^2, 1e-4). Derived in
/// docs/gate.md.
// clang-format on
struct RowMultipliers {
  RowVector l;           ///< m/s each m^2
  bool is_whole = true;  ///< false: no products were left; l keeps some of the rows
};

/// Finds them for two levels of the same rows, which must outlive it and stay as they are, within
/// so many products together.
class RowProblem {
 public:
  RowProblem(const SpeedRows& rows, int task_size, int products = kMostProducts) noexcept
      : rows_(rows), task_size_(task_size), products_left_(products) {}

  /// v_max_m_per_s: in place of the rows' own. share: of the products that are left it takes no
  /// more.
  RowMultipliers solve(const RowVector& v_max_m_per_s, const RowSpace& space, const Motion& motion,
                       double share = 1.0) noexcept;

  /// Adds to the motion what it takes to keep the rows, by kBothSpaces. Where no products are left,
  /// the whole motion is slowed down until it keeps all rows with v_max >= 0. Returns l.
  RowVector keep(Motion& motion) noexcept;

 private:
  void multiply() noexcept;
  void respond(const RowSpace& space, RowMatrix& K, RowVector& delta) const noexcept;
  template <typename Problem>
  RowMultipliers repeat(const RowMatrix& K, const RowVector& delta, const RowVector& lacking,
                        double negligible) noexcept;

  const SpeedRows& rows_;
  int task_size_;
  int products_left_;
  bool is_multiplied_ = false;  ///< not before a row lacks something
  RowMatrix in_all_, in_task_;  ///< a_i^T W^-1 a_j, and what of it is in the task space
};

/// v_max of the rows themselves.
RowVector ownSpeeds(const SpeedRows& rows) noexcept;

/// Adds M A^T l to the motion.
void addRows(const SpeedRows& rows, const RowVector& l, const RowSpace& space,
             Motion& motion) noexcept;

}  // namespace tactus
