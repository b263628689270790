#pragma once

#include <span>
#include <vector>

#include "tactus/math/serial_chain.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// One obstacle on one capsule, which no module feels.
struct UnsensedContact {
  double force_N = 0.0;  ///< friction included; 0: there was none
  int capsule = 0;       ///< as PlantConfig::capsules
  int obstacle = 0;      ///< as PlantConfig::obstacles
  double t_s = 0.0;
};

/// The capsules of the links among obstacles, which push on each of them as on the cover of a
/// module; one by x_m and y_m as an endless line. A place that two capsules share is pushed on
/// twice.
class LinkContacts {
 public:
  LinkContacts(const PlantConfig& plant, const ChainPose& pose);

  /// At the next step; adds to `torque` what contacts are to the joints, N or Nm. slid_m: of each
  /// obstacle, see Obstacle::touch(); empty: none slides.
  void touch(const SerialChain& chain, const ChainPose& pose, double t_s, ScaledVector& torque,
             std::span<Vector3> slid_m = {}) noexcept;

  int capsules() const noexcept { return static_cast<int>(links_.size()); }
  int obstacles() const noexcept { return obstacles_; }
  /// Of the last step, of an obstacle on a capsule.
  double force_N(int capsule, int obstacle) const noexcept {
    return links_[capsule].contacts[obstacle].force_N;
  }
  /// The strongest since the beginning.
  const UnsensedContact& largest() const noexcept { return largest_; }
  void forgetLargest() noexcept { largest_ = {}; }

 private:
  struct Contact {
    Obstacle obstacle;
    double force_N = 0.0;
  };
  struct Link {
    AttachedFrame frame;  ///< x along the axis, from its start
    double length_m, radius_m;
    Pose X_BaseLink;  ///< in the last step
    std::vector<Contact> contacts;
  };

  std::vector<Link> links_;
  int obstacles_;
  UnsensedContact largest_;
};

}  // namespace tactus
