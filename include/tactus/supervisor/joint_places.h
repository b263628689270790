#pragma once

#include <array>

#include "tactus/canopen/hardware_config.h"
#include "tactus/canopen/joint_tracking.h"
#include "tactus/math/types.h"

namespace tactus {

/// Where an arm may go on: where each joint was commanded to be at last, at first the scene's
/// start, or where its drive held it since. The task would pull an arm that somebody has pushed
/// away back as soon as it runs.
class JointPlaces {
 public:
  /// q_start: of the scene, m or rad.
  JointPlaces(const JointVector& q_start, const HardwareConfig& hardware);

  void coast() noexcept { places_.coast(); }  ///< cycles were missed since the last command()
  /// The arm is at q, m or rad, by a command that moves it on at `velocity`, m/s or rad/s.
  void command(const JointVector& q, const JointVector& velocity) noexcept;

  /// What is seen of a joint. Each by its own drive: one that lies says nothing of the others, a
  /// joint that was let go may have been pushed, and one that went further than any stop was not
  /// stopped: from where the last command put it, or just after missed cycles from where it was
  /// before them, or between, as a drive stops that heard nothing. is_holding: its drive holds it
  /// or slows it down.
  void observe(int joint, double q_measured, bool is_holding, bool is_let_go) noexcept;

  /// The joint's feedback cannot be believed: its place is the one that was commanded.
  void doubt(int joint) noexcept;

  /// The joint that is farthest from both places, if by more than HardwareConfig::start_tolerance;
  /// else -1. NaN is in no place.
  int outOfPlace(const JointVector& q_measured) const noexcept;

  const JointVector& commanded() const noexcept { return places_.now(); }
  double tolerance() const noexcept { return tolerance_; }  ///< m or rad

 private:
  CommandedPlaces places_;
  JointVector q_released_;  ///< where each joint's drive held it at last
  JointVector max_following_error_;
  JointVector stop_way_;  ///< the longest of a stop, from where each joint was commanded
  double stop_deadline_s_;
  double tolerance_;
  /// Since the last command each joint's drive was neither off nor cut off.
  std::array<bool, kMaxJoints> is_held_{};
};

}  // namespace tactus
