#pragma once

#include "tactus/scene/key_builders.h"
#include "tactus/scene/robot_config.h"

/// Rows of robot.yaml that make up HardwareConfig.
namespace tactus {

keys::Row<RobotConfig> canSection();
keys::Row<RobotConfig> drivesSection();
keys::Table<TactileModuleSection> moduleOnBusKeys();
keys::Row<RobotConfig> gpioSection();
keys::Row<RobotConfig> realTimeSection();

}  // namespace tactus
