#pragma once

#include <string>
#include <vector>

#include "tactus/scene/scene.h"

namespace tactus {

/// What is doubtful about the machine between controller and arm: what loads, but ends in a fault
/// of tactusd. For people, to be printed as warnings; none of a robot that only simulates.
std::vector<std::string> checkMachine(const Scene& scene);

}  // namespace tactus
