#pragma once

#include "tactus/bench/arm_bases.h"
#include "tactus/bench/body_regions.h"

namespace tactus {

/// A link runs into a region of a body that cannot get away.
struct BodyTrial {
  Variant law = Variant::kNullLimit;
  BodyRegion region;
  double speed_m_per_s = 0.1;  ///< of the contact point, at the touch
};

/// The base with the region in place of its profile, friction of 0.3, and the law: none, or
/// null_limit that bears 0.5. base: as lawGridSetup() wants it; arm stays the base's, but without
/// its own spring where it has no mass.
RunSetup bodySetup(const RunSetup& base, const BodyTrial& trial);

/// What the standard's model of a free region says of the same blow, N: v sqrt(k m), with both
/// masses in series; not measured for an arm without mass.
double freeBlow_N(const RunSetup& setup, const BodyTrial& trial, const JudgedRun& run);

}  // namespace tactus
