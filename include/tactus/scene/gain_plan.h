#pragma once

#include <string>
#include <vector>

#include "tactus/scene/scene.h"

/// Changes of the gains of a scene that runs: all of one is checked before any of it happens.
namespace tactus {

/// A change that may be made.
struct GainPlan {
  Scene scene;                    ///< as it will be
  bool waits_for_free = false;    ///< a key of it has to wait for a moment without contact
  std::vector<std::string> keys;  ///< that differ
};

/// The phase margin that a change of a scene's gains has to leave, deg: kMinPhaseMargin_deg, or
/// what the scene had when it was started, if that is less.
double leastMargin_deg(const Scene& started);

/// Lays settings over a scene that runs. Throws InputError, as a start with them would, or
///   - for a key that needs a restart,
///   - where the phase margin at one of five points of the ramp is less than least_deg; it says
///     which T would do.
GainPlan planSettings(const Scene& running, const std::vector<Override>& settings,
                      double least_deg);

/// The same of the scene as its files are now, with these settings alone, those of its start.
GainPlan planReload(const Scene& running, const std::vector<Override>& overrides, double least_deg);

/// The same of a scene that was made otherwise. Of what is live limits of speed that are raised
/// wait for a moment without contact, and all of null_task and null_joint.
GainPlan planChange(const Scene& running, Scene changed, double least_deg);

/// The keys whose values differ between two scenes, by dotted path; "robot" for all that is in
/// files of the robot.
std::vector<std::string> differingKeys(const Scene& one, const Scene& other);

}  // namespace tactus
