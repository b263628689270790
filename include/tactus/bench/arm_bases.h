#pragma once

#include <array>
#include <string>
#include <vector>

#include "tactus/bench/judged_run.h"

namespace tactus {

inline constexpr std::array kArms = {"quasi_static", "rigid_gears", "flexible_gears"};

/// One scene, whose arm has no mass, rigid gears or flexible ones; only as many as its robot knows.
using ArmBases = std::vector<RunSetup>;

/// Throws InputError.
ArmBases armBases(const std::string& scene_path);

}  // namespace tactus
