#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

#include "tactus/plant/plant.h"
#include "tactus/scene/scene.h"

namespace tactus {

struct PlantRunResult {
  PlantCounters plant;
  std::uint64_t interface_refused = 0;      ///< frames of the plant that the kernel did not take
  std::optional<UnsensedContact> unsensed;  ///< absent without capsules
};

/// Plays the scene's robot, which has hardware, on its CAN interfaces, in real time, until SIGTERM
/// or SIGINT. Says on `notes` when it is ready, what it goes without, and when the e-stop moves;
/// e_stop_file (none if empty) then holds, or as a FIFO gets, a line 1 or 0. Throws
/// std::system_error for an interface or file that can't be opened, an interface that is down, and
/// one that is removed meanwhile; std::runtime_error for one that another plant plays on, and for a
/// file that holds something else.
PlantRunResult runPlant(const Scene& scene, const std::string& e_stop_file, std::FILE* notes);

}  // namespace tactus
