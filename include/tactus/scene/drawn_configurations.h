#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// That tell what an arm can come to.
inline constexpr int kDrawnConfigurations = 200;

/// Of Halton's sequence, from number 1 on, over all that the limits leave, of a rail, too; half a
/// turn or a metre to each side where there are none.
JointVector drawnConfiguration(const SerialChain& chain, const JointLimits& limits, int number);

}  // namespace tactus
