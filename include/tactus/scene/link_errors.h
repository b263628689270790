#pragma once

#include <optional>
#include <vector>

#include "tactus/math/serial_chain.h"
#include "tactus/scene/robot_loader.h"

namespace tactus {

/// The chain of the simulated arm with `simulation.link_length_errors_m`, one a joint, added to the
/// way from that joint to the next one, or to the tool, along itself; absent without errors. Throws
/// InputError for a link without a length to change, and for one that is none then.
std::optional<SerialChain> loadPlantChain(const YamlNode& scene,
                                          const std::optional<std::vector<double>>& errors_m,
                                          const LoadedRobot& robot);

}  // namespace tactus
