#pragma once

#include <memory>
#include <vector>

#include "tactus/scene/drive_profile.h"
#include "tactus/scene/eds_file.h"
#include "tactus/scene/robot_config.h"
#include "tactus/scene/source_reader.h"

namespace tactus {

struct SceneSettings;

/// What robot.yaml names of a drive beside its own keys.
struct DriveSheet {
  std::shared_ptr<const EdsFile> eds;  ///< null: none
  DriveProfile profile;
};

/// One for each entry of drives.joints, in their order. Each file is read once, whoever names it.
/// robot: the file that names them. Throws InputError.
std::vector<DriveSheet> readDriveSheets(const SourceFile& robot, const YamlNode& root,
                                        const RobotConfig& config, const SceneSettings& settings,
                                        SourceReader& reader);

/// Takes what is not in robot.yaml from there: vendor and product, which the node has to have, and
/// how many transmit PDOs there are to be switched off. Throws InputError where they cannot be.
void applySheet(const DriveSheet& sheet, DriveConfig& drive);

}  // namespace tactus
