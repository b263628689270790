#pragma once

#include "tactus/scene/key_builders.h"
#include "tactus/scene/robot_config.h"

namespace tactus {

/// Of a section `cover`, of the robot or of its simulation.
keys::Table<CoverSection> coverLoadKeys();

/// length_m: of the cover, in the middle of which its centre is taken to be.
CoverConfig makeCover(const CoverSection& section, double length_m);

}  // namespace tactus
