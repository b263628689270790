#include "tactus/control/path_progress.h"

#include <algorithm>
#include <cmath>

namespace tactus {

ToolLag toolLag(const TaskConfig& task, const PaddedTaskVector& error) noexcept {
  ToolLag squared;
  for (int i = 0; i < task.size; ++i)
    (task.components[i] < 3 ? squared.position_m : squared.rotation_rad) += error[i] * error[i];
  return {std::sqrt(squared.position_m), std::sqrt(squared.rotation_rad)};
}

double pathProgress(double lag, double wait_beyond) noexcept {
  const double x = lag / wait_beyond - 1.0;
  if (x >= 1.0) return 0.0;
  if (x > 0.0) return 1.0 - x * x * (3.0 - 2.0 * x);
  return 1.0;
}

double pathProgress(const TaskGains& gains, const ToolLag& lag) noexcept {
  return std::min(pathProgress(lag.position_m, gains.wait_beyond_m),
                  pathProgress(lag.rotation_rad, gains.wait_beyond_rad));
}

bool waitsForTurn(const TaskGains& gains, const ToolLag& lag) noexcept {
  const double of_turn = pathProgress(lag.rotation_rad, gains.wait_beyond_rad);
  return of_turn < 1.0 && of_turn <= pathProgress(lag.position_m, gains.wait_beyond_m);
}

}  // namespace tactus
