#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// The ends of a module's cover, base frame, m.
struct CoverEnds {
  Vector3 p_BaseStart, p_BaseEnd;
};

CoverEnds coverEnds(const ChainPose& pose, const TactileModuleConfig& module) noexcept;

/// How much farther one end of the cover is from its link than the other, as a share of the cover's
/// length. The link is taken for the straight line from the joint that moves it to the next joint,
/// or the tip, that is elsewhere. Along a link it is 0, along one leg of a bent link at most
/// 1/sqrt(2), across and backwards 1; 0 where no such joint follows.
double shareOffLink(const SerialChain& chain, const ChainPose& pose,
                    const TactileModuleConfig& module) noexcept;

/// The longest way between two joints that follow each other, or from the last to the tip, and the
/// way over all of them, m. What is between base and first joint is no part of the arm.
struct ArmLengths {
  double longest_m = 0.0;
  int longest_joint = 0;  ///< the one that moves that link
  double all_m = 0.0;
};

ArmLengths armLengths(const SerialChain& chain, const ChainPose& pose) noexcept;

}  // namespace tactus
