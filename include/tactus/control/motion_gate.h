#pragma once

#include <optional>

#include "tactus/control/clearance.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/joint_limit_rows.h"
#include "tactus/control/speed_rows.h"

namespace tactus {

/// The one gate for all that a motion must not approach too fast: contacts, whose rows a law
/// brings, and what is known without a sensor: the clearance and the joints' limits. See
/// docs/gate.md.
class MotionGate {
 public:
  MotionGate(const ControllerConfig& config, const ScaledVector& inv_sqrt_weights);

  /// Null without a clearance; with one there is something to keep in every cycle.
  const Clearance* clearance() const noexcept { return clearance_ ? &*clearance_ : nullptr; }

  /// Adds what is known without a sensor. joint_share: see JointLimitRows.
  void add(const CommandedMotion& commanded, const TaskKinematics& kinematics, double joint_share,
           double period_s, SpeedRows& rows) const noexcept;

  /// Keeps these rows and those of add(), which it adds if there is one that the motion breaks.
  /// Returns l, in that order.
  RowVector keep(const CommandedMotion& commanded, const TaskKinematics& kinematics,
                 double joint_share, double period_s, SpeedRows& rows,
                 Motion& motion) const noexcept;

 private:
  bool isKept(const CommandedMotion& commanded, const TaskKinematics& kinematics, double period_s,
              const SpeedRows& rows, const Motion& motion) const noexcept;

  int task_size_;
  ScaledVector inv_sqrt_weights_;
  std::optional<Clearance> clearance_;
  JointLimitRows joint_limits_;
};

}  // namespace tactus
