#pragma once

#include <optional>

#include "tactus/scene/robot_loader.h"
#include "tactus/scene/scene_config.h"

namespace tactus {

/// What moves the simulated arm; none where it is quasi-static. Throws InputError where the robot
/// does not say enough, a joint moves no mass, or a gear rings faster than cycles of period_s show.
std::optional<ArmDynamicsConfig> loadDynamics(const YamlNode& scene, SimulatedArm arm,
                                              const LoadedRobot& robot, const JointVector& q_start,
                                              double period_s);

/// What covers that are behind gears need; none where no cover is. Throws InputError where the
/// robot does not say enough, or a joint moves no mass.
std::optional<GearedLinks> loadGearedLinks(const LoadedRobot& robot, const JointVector& q_start);

/// Of the motors that a blow on the links meets, too: none behind gears that give way.
JointVector rotorsOfLinks(const ArmDescription& arm);

/// What the robot says of itself, whatever is simulated; absent where that is not enough.
std::optional<ArmDescription> describeArm(const LoadedRobot& robot, const JointVector& q_start);

}  // namespace tactus
