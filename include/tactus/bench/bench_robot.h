#pragma once

#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"

namespace tactus {

/// An arm of any size, always built in the same way, so that only the number of joints differs.
struct BenchRobot {
  std::vector<Joint> joints;
  ControllerConfig config;  ///< with every stage if contacts = 1, without contact if 0
};

/// joints: 6 to 16. task_components: 3 (position) or 6. contacts: 0 or 1, on the middle link.
BenchRobot makeBenchRobot(int joints, int task_components, int contacts);

/// What the robot reads in this cycle: a push of a few newton, a new sample every fourth cycle.
RobotInput benchInput(const BenchRobot& robot, int cycle);

inline constexpr double kBenchPeriod_s = 0.001;

}  // namespace tactus
