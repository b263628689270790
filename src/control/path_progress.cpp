#include "tactus/control/path_progress.h"

namespace tactus {

double pathProgress(double lag_m, double wait_beyond_m) noexcept {
  const double x = lag_m / wait_beyond_m - 1.0;
  if (x >= 1.0) return 0.0;
  if (x > 0.0) return 1.0 - x * x * (3.0 - 2.0 * x);
  return 1.0;
}

}  // namespace tactus
