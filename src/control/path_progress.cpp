#include "tactus/control/path_progress.h"

#include <cmath>

namespace tactus {

double toolLag_m(const TaskConfig& task, const PaddedTaskVector& error) noexcept {
  double squared = 0.0;
  for (int i = 0; i < task.size; ++i)
    if (task.components[i] < 3) squared += error[i] * error[i];
  return std::sqrt(squared);
}

double pathProgress(double lag_m, double wait_beyond_m) noexcept {
  const double x = lag_m / wait_beyond_m - 1.0;
  if (x >= 1.0) return 0.0;
  if (x > 0.0) return 1.0 - x * x * (3.0 - 2.0 * x);
  return 1.0;
}

}  // namespace tactus
