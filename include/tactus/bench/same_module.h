#pragma once

#include "tactus/bench/several_grid.h"

namespace tactus {

/// Two posts on one module, each at its own place and time: of five cases three of kSameSide, one
/// of kAcross, one of kBothSides. Else as drawSeveral().
std::vector<SeveralCase> drawSameModule(const RunSetup& base, std::uint64_t seed, int count);

}  // namespace tactus
