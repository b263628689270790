#include "tactus/control/speed_rows.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kYielding_N_s_m = 1.5;  ///< delta_0
constexpr double kProximal = 1e-6;
constexpr int kRepetitions = 4;

RowMatrix responses(const SpeedRows& rows, const RowSpace& space, int task_size) {
  RowMatrix K(rows.size, rows.size);
  for (int i = 0; i < rows.size; ++i) {
    const SpeedRow& a = rows.row[i];
    for (int j = 0; j <= i; ++j) {
      const SpeedRow& b = rows.row[j];
      K(i, j) = K(j, i) = space.null_space * dot(a.a_scaled, b.a_scaled) +
                          (space.task - space.null_space) * dot(a.a_task, b.a_task, task_size);
    }
    K(i, i) = std::max({K(i, i), 1e-3 * dot(a.a_scaled, a.a_scaled), 1e-4});
  }
  return K;
}

/// delta
RowVector yielding(const SpeedRows& rows, const RowSpace& space, const RowMatrix& K) {
  RowVector delta(rows.size);
  for (int i = 0; i < rows.size; ++i) {
    const SpeedRow& row = rows.row[i];
    double opposition = 0.0;
    for (int j = 0; j < rows.size; ++j) {
      const double against = std::min(0.0, K(i, j));
      opposition += row.presence * rows.row[j].presence * (against * against / (K(i, i) * K(j, j)));
    }
    const double most =
        std::min(kYielding_N_s_m / row.damping_N_s_per_m, space.max_yielding * K(i, i));
    delta[i] = most * std::min(1.0, opposition) + kProximal * K(i, i);
  }
  return delta;
}

/// a^T q_dot
double speedAlong(const SpeedRow& row, int task_size, const Motion& motion) {
  return dot(row.a_scaled, motion.v_scaled) + dot(row.a_task, motion.y, task_size);
}

/// The motion as a whole, until it keeps the rows that standing still keeps.
void slowDown(const SpeedRows& rows, int task_size, Motion& motion) {
  double share = 1.0;
  for (int i = 0; i < rows.size; ++i) {
    const double approach = -speedAlong(rows.row[i], task_size, motion);
    const double v_max = rows.row[i].v_max_m_per_s;
    if (v_max >= 0.0 && share * approach > v_max) share = v_max / approach;
  }
  motion.v_scaled *= share;
  motion.y *= share;
}

}  // namespace

RowMultipliers findMultipliers(const SpeedRows& rows, const RowSpace& space, int task_size,
                               const Motion& motion, int steps) noexcept {
  RowVector lacking(rows.size);
  for (int i = 0; i < rows.size; ++i) {
    const SpeedRow& row = rows.row[i];
    lacking[i] = -row.v_max_m_per_s - dot(row.a_scaled, motion.v_scaled) -
                 dot(row.a_task, motion.y, task_size);
  }
  RowMultipliers found{RowVector::Zero(rows.size)};
  if ((lacking.array() <= 0.0).all()) return found;
  RowMatrix K = responses(rows, space, task_size);
  const RowVector delta = yielding(rows, space, K);
  K.diagonal() += delta;
  RowVector& l = found.l;
  for (int i = 0; i < kRepetitions && found.is_whole; ++i) {
    const RowVector d = lacking + delta.cwiseProduct(l);
    found.is_whole = solveComplementarity(K, d, l, steps);
  }
  return found;
}

void addRows(const SpeedRows& rows, const RowVector& l, const RowSpace& space,
             Motion& motion) noexcept {
  for (int i = 0; i < rows.size; ++i) {
    motion.v_scaled += space.null_space * l[i] * rows.row[i].a_scaled;
    motion.y += (space.task - space.null_space) * l[i] * rows.row[i].a_task;
  }
}

RowVector keepSpeedRows(const SpeedRows& rows, int task_size, Motion& motion, int steps) noexcept {
  const RowMultipliers found = findMultipliers(rows, kBothSpaces, task_size, motion, steps);
  addRows(rows, found.l, kBothSpaces, motion);
  if (!found.is_whole) slowDown(rows, task_size, motion);
  return found.l;
}

}  // namespace tactus
