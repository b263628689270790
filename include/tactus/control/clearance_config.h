#pragma once

#include <optional>
#include <vector>

#include "tactus/math/link_capsule.h"
#include "tactus/math/shortest_distance.h"

namespace tactus {

/// Capsules to keep apart, by their places in ClearanceConfig::capsules.
struct CapsulePair {
  int capsule = 0;
  int other = 0;
};

/// A capsule and what it must not come through, by their places.
struct WallPair {
  int capsule = 0;
  int wall = 0;
};

/// What the null space does to keep clear early: see clearance_cost.h.
struct ClearanceAvoidance {
  double distance_m = 0.15;  ///< d_a, > d_s
  double gain_per_s = 2.0;
};

/// What an arm must keep clear of: of itself, of bodies and of walls. Distances are between
/// surfaces.
struct ClearanceConfig {
  std::vector<LinkCapsule> capsules;  ///< of links, and of bodies that are fixed to the base
  std::vector<CapsulePair> pairs;     ///< of which one at least moves, not both with one joint
  std::vector<HalfSpace> walls;       ///< base frame
  std::vector<WallPair> wall_pairs;   ///< of capsules that move
  double safe_distance_m = 0.02;      ///< d_s: never less
  double influence_distance_m = 0.1;  ///< d_i > d_s: what is further away limits nothing
  std::optional<ClearanceAvoidance> avoid{};
};

}  // namespace tactus
