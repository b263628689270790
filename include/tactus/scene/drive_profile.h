#pragma once

#include "tactus/scene/scene.h"

namespace tactus {

/// What a drive does otherwise than CiA 402 says, from a YAML file of these keys:
///   source: where that is shown, for whoever reads the file
///   without: a list of words, what the set-up leaves out: quick_stop_option is entry 605A,
///            velocity_unit is 60A9, speed_limit is 607F
struct DriveProfile {
  bool has_quick_stop_option = true;
  bool has_velocity_unit = true;
  bool has_speed_limit = true;
};

/// Throws InputError.
DriveProfile parseDriveProfile(const SourceFile& file);

}  // namespace tactus
