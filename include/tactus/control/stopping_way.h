#pragma once

#include <array>

#include "tactus/control/controller_config.h"

namespace tactus {

/// What an arm still does that stops now, all joints together and as fast as the slowest of them
/// can: it follows the straight q + tau q_dot for 0 <= tau <= time_s.
struct StoppingWay {
  double time_s = 0.0;                 ///< dt at least, as this cycle's motion is made in any case
  double speed_m_per_s = 0.0;          ///< no point of a capsule's axis moves faster at its begin
  double acceleration_m_per_s2 = 0.0;  ///< nor bends its way more, at any tau
};

/// Of joints' speeds times their levers, of all before each joint, m/s: no point moves faster
/// against another one than the joints between them make it.
using SpeedSums = std::array<double, kMaxJoints + 1>;

// clang-format off: equations
/// With the joints' accelerations a_j, T = max_j |v_j| / a_j and x = T / dt, m = floor(x): the
/// cycles of a ramp dt v (1 - i / x) add up to
///   time = dt (m + 1) (1 - m / (2 x))
/// No point that joint j moves is further from it than r_j, the stretched way from there on; 1 in
/// its place for a prismatic one. From J_p v and J_p_dot v with unit axes
///   speed = sum_j |v_j| r_j
///   acceleration = sum_j |v_j| r_j ([j revolute] |v_j| + 2 sum_k<j,revolute |v_k|)
// clang-format on
class StoppingWays {
 public:
  StoppingWays(const ControllerConfig& config, const std::vector<LinkCapsule>& capsules);

  StoppingWay of(const JointVector& q, const JointVector& velocity, double period_s) const noexcept;

  SpeedSums speedSums(const JointVector& q, const ScaledVector& velocity) const noexcept;

  /// T: until it stands.
  double ramp_s(const JointVector& velocity) const noexcept;

 private:
  using PerJoint = std::array<double, kMaxJoints>;
  PerJoint levers_m(const JointVector& q, const JointVector& velocity,
                    double time_s) const noexcept;

  SerialChain chain_;
  JointVector q_measured_;  ///< where the lengths were
  PerJoint inv_acceleration_{};
  PerJoint turns_{};        ///< 1 of a revolute joint, else 0
  PerJoint to_next_m_{};    ///< from each joint to the next one
  PerJoint own_m_{};        ///< from it to the furthest end of its own capsules
  bool lengthens_ = false;  ///< by a prismatic joint behind a revolute one
  PerJoint lever_m_;        ///< r_j, if it does not
};

}  // namespace tactus
