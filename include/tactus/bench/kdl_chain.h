#pragma once

#include <kdl/chain.hpp>
#include <kdl/jntarray.hpp>

#include "tactus/bench/bench_robot.h"

namespace tactus {

inline KDL::Vector toKdl(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

inline KDL::JntArray jointArray(const JointVector& q) {
  KDL::JntArray joints(static_cast<unsigned>(q.size()));
  joints.data = q;
  return joints;
}

/// The robot up to a frame, one segment a joint: the least that KDL can do with. The frames of a
/// BenchRobot are not rotated.
KDL::Chain kdlChain(const BenchRobot& robot, const AttachedFrame& end);

}  // namespace tactus
