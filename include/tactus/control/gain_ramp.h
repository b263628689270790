#pragma once

#include "tactus/control/gains.h"

namespace tactus {

/// The gains between two sets: share 0 is `from`, 1 is `to`, both to the bit. Times T and
/// stiffnesses go in equal ratios, all others in equal steps. One that is infinite in either set
/// has no way between: it is the one of `to` from the first step on.
Gains gainsBetween(const Gains& from, const Gains& to, double share) noexcept;

/// max(0.5 s, 5 T) of the slower set, s: contacts settle several times on the way. Where F_act is
/// raised also 8 / beta, but of that 10 s at most: a tool that was held off its path comes back no
/// faster than the limit rises, for behind something soft it may meet something stiff.
double gainRampDuration_s(const Gains& from, const Gains& to) noexcept;

}  // namespace tactus
