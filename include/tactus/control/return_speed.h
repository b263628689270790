#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

inline bool hasReturnSpeed(const TaskConfig& task) noexcept {
  return task.max_return_speed_m_per_s || task.max_return_speed_rad_per_s;
}

/// Scales a correction of the task's components, m/s and rad/s, down to the return speeds, see
/// TaskConfig; push: p there, or empty.
void limitReturnSpeed(const TaskConfig& task, const TaskVector& push,
                      TaskVector& correction) noexcept;

}  // namespace tactus
