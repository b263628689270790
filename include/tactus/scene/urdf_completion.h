#pragma once

#include <string>
#include <vector>

#include "tactus/scene/scene.h"

/// What a URDF leaves open before it is the arm of a robot.yaml.
namespace tactus {

/// A link that nothing hangs on, and how many joints move it.
struct ArmEnd {
  std::string link;
  int moving_joints;
};

/// All of a URDF, the ones that most joints move first. Throws InputError.
std::vector<ArmEnd> armEnds(const SourceFile& urdf);

/// Limits of a joint that no URDF said.
struct AssumedLimit {
  std::string joint, what;  ///< as "lower, upper and velocity"
};

struct CompletedUrdf {
  std::string text;                   ///< with comments where it was changed; empty if it was not
  std::vector<AssumedLimit> assumed;  ///< in the order from the base to the tip
};

/// Gives the joints on the way to a link the limits that they lack, or have as exporters write them
/// that know none, zero: +-2.5 rad or +-0.25 m, and 0.5 rad/s or 0.1 m/s. Throws InputError.
CompletedUrdf completeLimits(const SourceFile& urdf, const std::string& tip);

}  // namespace tactus
