#include "tactus/control/speed_rows.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kNullSpaceShare = 30.0;  ///< kappa
constexpr double kYielding_N_s_m = 1.5;   ///< delta_0
constexpr double kProximal = 1e-6;
constexpr int kRepetitions = 4;

RowMatrix responses(const SpeedRows& rows, int task_size) {
  RowMatrix K(rows.size, rows.size);
  for (int i = 0; i < rows.size; ++i) {
    const SpeedRow& a = rows.row[i];
    for (int j = 0; j <= i; ++j) {
      const SpeedRow& b = rows.row[j];
      K(i, j) = K(j, i) = kNullSpaceShare * dot(a.a_scaled, b.a_scaled) +
                          (1.0 - kNullSpaceShare) * dot(a.a_task, b.a_task, task_size);
    }
    K(i, i) = std::max({K(i, i), 1e-3 * dot(a.a_scaled, a.a_scaled), 1e-4});
  }
  return K;
}

/// delta
RowVector yielding(const SpeedRows& rows, const RowMatrix& K) {
  RowVector delta(rows.size);
  for (int i = 0; i < rows.size; ++i) {
    double opposition = 0.0;
    for (int j = 0; j < rows.size; ++j) {
      const double against = std::min(0.0, K(i, j));
      opposition += against * against / (K(i, i) * K(j, j));
    }
    delta[i] = kYielding_N_s_m / rows.row[i].damping_N_s_per_m * std::min(1.0, opposition) +
               kProximal * K(i, i);
  }
  return delta;
}

}  // namespace

RowVector keepSpeedRows(const SpeedRows& rows, int task_size, Motion& motion) noexcept {
  RowVector lacking(rows.size);
  for (int i = 0; i < rows.size; ++i) {
    const SpeedRow& row = rows.row[i];
    lacking[i] = -row.v_max_m_per_s - dot(row.a_scaled, motion.v_scaled) -
                 dot(row.a_task, motion.y, task_size);
  }
  RowVector l = RowVector::Zero(rows.size);
  if ((lacking.array() <= 0.0).all()) return l;
  RowMatrix K = responses(rows, task_size);
  const RowVector delta = yielding(rows, K);
  K.diagonal() += delta;
  for (int i = 0; i < kRepetitions; ++i) {
    const RowVector d = lacking + delta.cwiseProduct(l);
    RowVector next = l;
    if (!solveComplementarity(K, d, next)) break;
    l = next;
  }
  for (int i = 0; i < rows.size; ++i) {
    motion.v_scaled += kNullSpaceShare * l[i] * rows.row[i].a_scaled;
    motion.y += (1.0 - kNullSpaceShare) * l[i] * rows.row[i].a_task;
  }
  return l;
}

}  // namespace tactus
