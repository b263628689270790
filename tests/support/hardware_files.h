#pragma once

#include <string>

#include "support/scene_files.h"

/// The small scene with a robot that is connected to two buses and some GPIO lines.
namespace tactus::test {

inline const std::string kHardwareRobotText = R"(urdf: robot.urdf
tip: tool
home: [0, 0.5, -0.5]
can:
  buses:
    - {interface: can0}
    - {interface: can1, bit_rate_per_s: 9e5}
  master_node_id: 100
  heartbeat_period_s: 0.04
  heartbeat_timeout_s: 0.1
drives:
  start_tolerance: 0.03
  joints:
    - {joint: roll, interface: can1, node_id: 9, counts_per_rad: 2e6, sign: -1, tracking_gain_per_s: 10}
    - {joint: lift, interface: can0, node_id: 1, counts_per_m: 1e7, offset_m: 0.25, max_following_error_m: 0.01}
    - {joint: shoulder, interface: can0, node_id: 2, counts_per_rad: 1e6, offset_rad: -0.5}
tactile_module:
  interface: can1
  first_id: 0x110
  filter_in_daemon: true
  tare: {samples: 20}
)" + kModuleText + R"(gpio:
  chip: gpiochip1
  e_stop: {line: 3, active_low: true, debounce_s: 0.01}
  brake: {line: 5}
real_time: {priority: 70, cpu: 1}
)";

/// All three joints have limits: counts of a continuous one would overflow.
inline SceneFiles hardwareFiles() {
  SceneFiles files;
  files.robot = kHardwareRobotText;
  files.urdf = replaced(files.urdf, "type=\"continuous\"", "type=\"revolute\"");
  files.urdf = replaced(files.urdf, "<limit velocity=\"2\"/>",
                        "<limit lower=\"-3\" upper=\"3\" velocity=\"2\"/>");
  return files;
}

}  // namespace tactus::test
