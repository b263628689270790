#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"

namespace tactus {

/// How a cover moves, and what of it has come through the filter of its module.
struct CoverCompensationState {
  bool has_started = false;
  LinkObserverState links;                 ///< only with gears
  double missed_s = 0.0;                   ///< of cycles since the last one
  Vector3 p_BaseCenter = Vector3::Zero();  ///< m
  Vector3 v_BaseCenter = Vector3::Zero();  ///< m/s
  Wrench5 origin = Wrench5::Zero();        ///< of the filter, which knows only differences from it
  Wrench5 s0 = Wrench5::Zero(), s1 = Wrench5::Zero(), s2 = Wrench5::Zero();  ///< of the filter
};

/// Takes weight and inertia of the cover out of the samples of a tactile module:
///   reading = contact + L(t) - L_tare,   L = H [ m R^T (g - a) at the centre of mass ]
/// with the module's filter H, without which the two would differ while the arm accelerates. R and
/// a follow from the measured joints, which are late by the same as the samples: by the way from
/// the robot, and not by the drives. Where gears are flexible and drives measure motors, the links
/// are reckoned from those: what motors do beyond the gears' first mode is not the cover's, and
/// taken for it swings worse than no compensation. The tare was taken where the controller starts.
class CoverCompensation {
 public:
  /// module: with a cover. One of the controller's.
  CoverCompensation(const ControllerConfig& config, const TactileModuleConfig& module);

  /// Once a cycle. q: measured, m or rad, one a joint. What the sample says of contacts alone.
  TactileSample relieve(const TactileSample& sample, const JointVector& q, double period_s,
                        CoverCompensationState& state) const noexcept;

 private:
  Wrench5 load(const JointVector& q, double period_s, CoverCompensationState& state) const noexcept;

  SerialChain chain_;
  std::optional<GearedLinks> geared_links_;
  AttachedFrame link_;
  CoverConfig cover_;
  bool feels_moment_x_;
  Vector3 gravity_Base_;
  double filter_cutoff_hz_;
  Wrench5 at_tare_;
};

}  // namespace tactus
