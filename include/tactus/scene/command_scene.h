#pragma once

#include <string>
#include <vector>

#include "tactus/scene/scene_loader.h"

/// What the commands share that take a scene and settings on the command line.
namespace tactus {

/// Of the option --set, wherever it is.
inline constexpr const char* kSetHelp =
    "Replace a value, as in --set controller.damping=0.7 or, of the robot, --set "
    "robot.drives.position_lag_s=0.01; may be given several times, each key once";

/// Of all --set KEY=VALUE. Throws InputError; also for a key that is given twice, as one of the two
/// is a slip, and which of them would hold is nowhere to be seen.
std::vector<Override> parseOverrides(const std::vector<std::string>& settings);

/// A scene whose robot has buses and drives; purpose says what they are for and ends the message,
/// as in "to play". Throws InputError.
Scene loadHardwareScene(const std::string& path, const std::vector<std::string>& settings,
                        const char* purpose);

}  // namespace tactus
