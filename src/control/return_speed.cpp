#include "tactus/control/return_speed.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

/// Of the components of position or of those of rotation.
void limitPart(const TaskConfig& task, bool is_position, double max_speed, const TaskVector& push,
               TaskVector& correction) noexcept {
  const auto isPart = [&](int i) { return (task.components[i] < 3) == is_position; };
  double squared = 0.0;
  double dot = 0.0;
  for (int i = 0; i < task.size; ++i) {
    if (!isPart(i)) continue;
    squared += correction[i] * correction[i];
    if (push.size() > 0) dot += push[i] * correction[i];
  }
  const double speed = std::sqrt(squared);
  if (speed == 0.0) return;
  const double allowed = std::max(0.0, max_speed - dot / speed);
  if (speed <= allowed) return;
  for (int i = 0; i < task.size; ++i)
    if (isPart(i)) correction[i] *= allowed / speed;
}

}  // namespace

void limitReturnSpeed(const TaskGains& gains, const TaskConfig& task, const TaskVector& push,
                      TaskVector& correction) noexcept {
  if (gains.max_return_speed_m_per_s < kNoLimit)
    limitPart(task, true, gains.max_return_speed_m_per_s, push, correction);
  if (gains.max_return_speed_rad_per_s < kNoLimit)
    limitPart(task, false, gains.max_return_speed_rad_per_s, push, correction);
}

void softenWayOut(double share, const ScaledVector& before, const ScaledVector& added,
                  ScaledVector& way_out) noexcept {
  const double answer_share = std::min(1.0, share * (kReturnRise_s / kAnswerRise_s));
  for (int i = 0; i < kMaxJoints; ++i) {
    const double softened =
        way_out[i] - (1.0 - share) * added[i] - (1.0 - answer_share) * before[i];
    way_out[i] = std::clamp(softened, std::min(0.0, way_out[i]), std::max(0.0, way_out[i]));
  }
}

}  // namespace tactus
