#pragma once

#include "tactus/analysis/contact_loop.h"

namespace tactus {

struct StabilityMargins {
  /// c_e / c up to which the loop is stable; 0: it is not even for soft contacts (1e-3); infinite:
  /// no end was found up to 1e6.
  double largest_stiffness_ratio = 0.0;
  double gain_margin = 0.0;       ///< how often the ratio asked for fits into it
  double phase_margin_rad = 0.0;  ///< at the ratio asked for; 0 where it is unstable
};

/// Margins of a contact stiffness_ratio > 0 times as stiff as assumed, exact to about 1e-9. The
/// loop is opened at the force sample: the gain margin is the factor, the phase margin the angle by
/// which a sample may be wrong. Needs stepsOfCommonPeriod(loop) > 0. Not for the cycle: takes
/// milliseconds.
StabilityMargins computeMargins(const ContactLoop& loop, double stiffness_ratio);

/// The c_e / c up to which a loop is stable with this phase margin; 0: with none; infinite: no end
/// was found up to 1e6. Where a loop is unstable over less than a quarter of the ratio, with gears
/// over less than 5 %, and then stable again, that may be stepped over.
double largestStiffnessRatio(const ContactLoop& loop, double phase_margin_rad);

/// The T from which on a loop that lacks this phase margin at this ratio would have it, s; infinite
/// if there is none up to 100 s.
double smallestTimeConstant(ContactLoop loop, double stiffness_ratio, double phase_margin_rad);

}  // namespace tactus
