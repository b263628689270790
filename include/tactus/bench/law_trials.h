#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tactus/bench/judged_run.h"

namespace tactus {

/// The whole grid of laws once more, with something that is worse, or left out.
struct LawTrial {
  std::string name;
  std::function<void(RunSetup&)> change;
};

/// What arms and sensors do when all is not well: noise, rare samples, a contact point that is
/// off, a sensor at its end, obstacles that move.
std::vector<LawTrial> lawDisturbances();

/// null_limit without one of its parts, as far as a value of the configuration leaves it out.
std::vector<LawTrial> lawAblations();

}  // namespace tactus
