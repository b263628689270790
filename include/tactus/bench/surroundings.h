#pragma once

#include <optional>

#include "tactus/bench/judged_run.h"
#include "tactus/bench/random.h"
#include "tactus/control/body_distances.h"

namespace tactus {

/// What else a motion has to keep.
enum class Surroundings {
  kOpen,
  kJointLimits,  ///< one to three joints start near a limit
  kBodies,       ///< the base's: of the arm itself, and what its scene must not touch
  kWall,         ///< upright, near to the arm somewhere
};
inline constexpr int kSurroundings = 4;
const char* surroundingsName(Surroundings kind);

/// Around the start of a setup; false where that is not clear. Without `clearance` in the base,
/// kBodies and kWall are as kOpen.
bool surround(BenchRandom& draw, Surroundings kind, RunSetup& setup);

class ClearanceWatch {
 public:
  explicit ClearanceWatch(const ControllerConfig& config);

  /// Least distance of all pairs, less the safe one, m; infinite without `clearance`.
  double left_m(const JointVector& q);

 private:
  SerialChain chain_;
  std::optional<BodyDistances> distances_;
  double safe_m_ = 0.0;
  ChainPose pose_{};
};

}  // namespace tactus
