#include "tactus/sim/drive_setpoints.h"

#include <cmath>

namespace tactus {

DriveSetpoints::DriveSetpoints(const DriveEffectsConfig& config, int joints, double step_s)
    : max_change_(step_s * config.max_acceleration), reference_(JointVector::Zero(joints)) {
  constexpr double kTolerance = 1e-9;  // of a step that the division misses
  const double steps = config.dead_time_s / step_s;
  const double whole_steps = std::floor(steps + kTolerance);
  late_share_ = std::max(0.0, steps - whole_steps);
  line_.assign(static_cast<std::size_t>(whole_steps) + 2, reference_);
}

const JointVector& DriveSetpoints::update(const JointVector& setpoint) noexcept {
  newest_ = (newest_ + 1) % line_.size();
  line_[newest_] = setpoint;
  const JointVector& oldest = line_[(newest_ + 1) % line_.size()];
  const JointVector& next = line_[(newest_ + 2) % line_.size()];
  JointVector change = next + late_share_ * (oldest - next) - reference_;
  if (max_change_.size() > 0) change = change.cwiseMin(max_change_).cwiseMax(-max_change_);
  reference_ += change;
  return reference_;
}

}  // namespace tactus
