#pragma once

#include <vector>

#include "tactus/math/mass_matrix.h"
#include "tactus/scene/urdf_loader.h"

namespace tactus {

/// The bodies of a URDF whose chain has been loaded: all links that move with each joint of the
/// chain, as one; links on joints beside the chain count where those are at zero. Throws InputError
/// for inertias that no body has.
std::vector<BodyInertia> loadUrdfBodies(const SourceFile& file, const UrdfChain& chain);

}  // namespace tactus
