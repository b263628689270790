#pragma once

#include <cstdint>

#include "tactus/control/contact_point.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/cover_compensation.h"
#include "tactus/control/fault.h"
#include "tactus/control/robot.h"

namespace tactus {

/// What is known of one tactile module.
struct TactileReading {
  std::uint32_t sequence = 0;    ///< of the newest sample
  double age_s = 0.0;            ///< of that sample
  Fault fault = Fault::kNone;    ///< of that sample; not of its age
  FaultDetail detail;            ///< of that fault, or of a sample too old
  ContactPointState contact;     ///< of the newest valid sample
  ContactPointState hardest;     ///< push of late, its force less what has faded since
  ContactPointState excess;      ///< of the newest sample beyond the module's range
  bool has_excess = false;       ///< the newest sample is one, and all of it is numbers
  CoverCompensationState cover;  ///< only of a module with one
  bool is_lost = false;          ///< the arm goes on without it; see module_loss.h
  double unproven_s = 0.0;       ///< to be good for before it counts as before
};

/// A push fades with this time constant: an arm that swings in a contact is back by then; or, if
/// that is longer, with so many periods of the module's cut-off frequency: after a blow its filter
/// tells of up to an eighth of it from the other side before it rests.
inline constexpr double kPushFades_s = 0.1;
inline constexpr double kPushFadesPeriods = 1.5;

/// A new sample is judged and located, an old one ages by a period. Returns kNone, kTactileInvalid
/// or kTactileStale.
Fault readSample(const TactileModuleConfig& module, const TactileSample& sample, double period_s,
                 TactileReading& reading) noexcept;

/// Of the sample a period after the last cycle, s.
double sampleAge_s(const TactileSample& sample, double period_s,
                   const TactileReading& reading) noexcept;

}  // namespace tactus
