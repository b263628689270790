#pragma once

#include "tactus/control/tactile_channels.h"

namespace tactus {

// clang-format off: equations
/// The smallest force across a cover, at any place along it and in any direction, with which the
/// first channel comes to its rail, N. Channels share a force as the smallest ones that make it up,
/// P = C^T (C C^T)^-1, as those of the simulated module do:
///   F = rail / (counts_per_N max |(p_y + x p_Mz, p_z - x p_My)|)
/// over all channels; the length of that vector is convex in x, so it is largest at an end.
/// Friction and what a channel shows at rest are not in it: a real one may end sooner.
// clang-format on
double railForce_N(const TactileChannels& channels, double length_m);

}  // namespace tactus
