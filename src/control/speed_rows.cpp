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
    const double length_squared = dot(a.a_scaled, a.a_scaled);
    const double difference = space.task - space.null_space;
    for (int j = 0; j < i; ++j) {
      const SpeedRow& b = rows.row[j];
      K(i, j) = K(j, i) = space.null_space * dot(a.a_scaled, b.a_scaled) +
                          difference * dot(a.a_task, b.a_task, task_size);
    }
    const double own =
        space.null_space * length_squared + difference * dot(a.a_task, a.a_task, task_size);
    K(i, i) = std::max({own, 1e-3 * length_squared, 1e-4});
  }
  return K;
}

/// delta
RowVector yielding(const SpeedRows& rows, const RowSpace& space, const RowMatrix& K) {
  RowVector delta(rows.size);
  for (int i = 0; i < rows.size; ++i) {
    const SpeedRow& row = rows.row[i];
    const double K_ii = K(i, i);
    double opposition = 0.0;
    for (int j = 0; j < rows.size; ++j) {
      const double against = K(j, i);
      if (against >= 0.0) continue;
      opposition += row.presence * rows.row[j].presence * (against * against / (K_ii * K(j, j)));
    }
    delta[i] = kProximal * K_ii;
    if (opposition == 0.0) continue;
    const double most =
        std::min(kYielding_N_s_m / row.damping_N_s_per_m, space.max_yielding * K_ii);
    delta[i] += most * std::min(1.0, opposition);
  }
  return delta;
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
  if ((lacking.array() <= 0.0).all()) return {RowVector::Zero(rows.size)};
  RowMatrix K = responses(rows, space, task_size);
  const RowVector delta = yielding(rows, space, K);
  for (int i = 0; i < rows.size; ++i) K(i, i) += delta[i];
  Complementarity problem(K);
  RowVector d = lacking;
  bool is_whole = problem.solve(d, steps);
  for (int i = 1; i < kRepetitions && is_whole; ++i) {
    for (int row = 0; row < rows.size; ++row) d[row] = lacking[row] + delta[row] * problem.l()[row];
    if (rows.is_of_one_contact) problem.forget();
    is_whole = problem.solve(d, steps);
  }
  return {problem.l(), is_whole};
}

void addRows(const SpeedRows& rows, const RowVector& l, const RowSpace& space,
             Motion& motion) noexcept {
  for (int i = 0; i < rows.size; ++i) {
    if (l[i] == 0.0) continue;
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
