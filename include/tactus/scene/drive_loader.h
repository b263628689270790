#pragma once

#include <string>
#include <vector>

#include "tactus/scene/drive_sheets.h"
#include "tactus/scene/robot_config.h"
#include "tactus/scene/urdf_loader.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// A robot.yaml that has been read, while its values are checked against each other and the URDF.
struct LoadingRobot {
  const YamlNode& root;
  const RobotConfig& config;
  const CanSection& can;
  const UrdfChain& chain;
  const std::vector<DriveSheet>& sheets;  ///< one for each entry of drives.joints

  /// Throws InputError at the value of a dotted path.
  [[noreturn]] void fail(const std::string& path, const std::string& problem,
                         const std::string& expectation) const {
    failAt(locate(root, path), path, problem, "expected " + expectation);
  }
};

/// The names of can.buses, for errors.
std::string listOfBuses(const LoadingRobot& robot);

/// Index of a bus by its interface, which `path` gives. Throws InputError if there is none.
int findBus(const LoadingRobot& robot, const std::string& interface, const std::string& path);

/// One drive a joint, in the order of the joints. Throws InputError.
std::vector<DriveConfig> loadDrives(const LoadingRobot& robot);

}  // namespace tactus
