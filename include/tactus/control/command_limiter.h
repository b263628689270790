#pragma once

#include "tactus/control/controller_config.h"

namespace tactus {

/// The last gate before the drives. What passes is finite and within the velocity, acceleration and
/// position limits of every joint, whatever came in.
///
/// Velocity and acceleration limits shorten the whole command, so that the arm keeps its direction;
/// only where no multiple of the command is admissible does each joint go by itself, towards the
/// command that limits of speed shorten, so that the direction is lost until the slowest of them
/// has got there by its own acceleration. Near a position limit a joint is slowed by itself, so
/// that it can still brake (|v| <= sqrt(2 a d) - a period / 2): scaling the others with it would
/// freeze the arm in contact.
class CommandLimiter {
 public:
  explicit CommandLimiter(const JointLimits& limits);

  /// q: present desired joints, within limits; velocity_before: the previous result; period_s: the
  /// same in every cycle (braking counts on it). Returns false, and lets the arm ramp to rest, if
  /// `velocity` is not finite.
  bool apply(const JointVector& q, const JointVector& velocity_before, double period_s,
             JointVector& velocity) const noexcept;

  /// Whether apply() leaves `velocity` alone as far as can be seen at a glance, which is what it
  /// does in most cycles; false: ask it.
  bool admits(const JointVector& q, const JointVector& velocity_before, double period_s,
              const JointVector& velocity) const noexcept;

 private:
  JointLimits limits_;
};

}  // namespace tactus
