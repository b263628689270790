#include "tactus/analysis/cover_geometry.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kElsewhere_m = 1e-4;

/// Of joint i, or of the tip behind the last one; base frame, m.
Vector3 placeOf(const SerialChain& chain, const ChainPose& pose, int i) {
  return i < chain.size() ? pose.p_BaseJoint[i] : framePosition(pose, chain.tip());
}

double distanceToSegment(const Vector3& p, const Vector3& start, const Vector3& end) {
  const Vector3 way = end - start;
  const double share = std::clamp((p - start).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (p - start - share * way).norm();
}

}  // namespace

CoverEnds coverEnds(const ChainPose& pose, const TactileModuleConfig& module) noexcept {
  const Pose X_BaseModule = framePose(pose, module.link);
  return {X_BaseModule.p_AB, X_BaseModule.p_AB + module.length_m * X_BaseModule.R_AB.col(0)};
}

double shareOffLink(const SerialChain& chain, const ChainPose& pose,
                    const TactileModuleConfig& module) noexcept {
  const Vector3 start = placeOf(chain, pose, module.link.joint);
  int next = module.link.joint + 1;
  while (next < chain.size() && (placeOf(chain, pose, next) - start).norm() < kElsewhere_m) ++next;
  const Vector3 end = placeOf(chain, pose, next);
  if ((end - start).norm() < kElsewhere_m) return 0.0;
  const CoverEnds cover = coverEnds(pose, module);
  return std::abs(distanceToSegment(cover.p_BaseEnd, start, end) -
                  distanceToSegment(cover.p_BaseStart, start, end)) /
         module.length_m;
}

ArmLengths armLengths(const SerialChain& chain, const ChainPose& pose) noexcept {
  ArmLengths lengths;
  for (int i = 0; i < chain.size(); ++i) {
    const double length_m = (placeOf(chain, pose, i + 1) - placeOf(chain, pose, i)).norm();
    lengths.all_m += length_m;
    if (length_m <= lengths.longest_m) continue;
    lengths.longest_m = length_m;
    lengths.longest_joint = i;
  }
  return lengths;
}

}  // namespace tactus
