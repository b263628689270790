#pragma once

#include "tactus/control/body_distances.h"
#include "tactus/control/motion.h"
#include "tactus/control/speed_rows.h"
#include "tactus/control/stopping_way.h"

namespace tactus {

// clang-format off: equations
/// Keeps an arm clear of itself, of walls and of bodies, by d >= d_s of all pairs.
///
/// What is wanted is slowed down by rows, of what is nearer than d_i:
///   grad(d)^T q_dot >= -(d - d_min) min(gamma, 1 / time) / p,   D = m_w / gamma
/// p = (d_i - d) / (d_i - d_s), at most 1, so that none begins with a step (times p for d < d_min);
/// gamma = 5 / s, m_w = 1e7 N/m, time that of the StoppingWay of the velocity before, and
///   d_min = d_s + min(1 mm, (d_i - d_s) / 10) + 1/2 acceleration time^2
/// But rows are of first order, the nearest alone, may exclude each other, and the limiter may not
/// be able to follow them. So a command passes only if the arm could still stop after it, all
/// joints together: d, as it is left after time q_dot with the normal held (see leftAfter_m), shall
///   d_left - 1/2 acceleration time^2 >= min(d_s, d)
/// which is a lower bound of d all the way; of what is beyond the near ones
///   d - speed time >= min(d_s, d)
/// and q + time q_dot be within the joints' limits. Else it passes as far as that holds of
///   q_dot_ramp + s (q_dot - q_dot_ramp),   0 <= s <= 1
/// where q_dot_ramp goes on with that stop from the velocity before, which is known to be clear.
/// Cycles that are missed are not part of that.
// clang-format on
class Clearance {
 public:
  /// As BodyDistances. config: with a clearance.
  explicit Clearance(const ControllerConfig& config);

  const BodyDistances& distances() const noexcept { return distances_; }

  /// What is near enough for rows and costs.
  void findNear(const ChainPose& pose, NearBodies& near) const noexcept {
    distances_.findNear(pose, reach_m_, near);
  }

  /// The rows, at q with this velocity before, m/s or rad/s.
  void add(const NearBodies& near, const TaskKinematics& kinematics,
           const ScaledVector& inv_sqrt_weights, const JointVector& q,
           const JointVector& velocity_before, double period_s, SpeedRows& rows) const noexcept;

  /// Whether a motion with this velocity keeps all of add().
  bool isKept(const ChainPose& pose, const NearBodies& near, const ScaledVector& velocity,
              const JointVector& q, const JointVector& velocity_before,
              double period_s) const noexcept;

  /// Whether the arm could still stop after a cycle with this velocity, at q with this pose.
  bool canStopAfter(const ChainPose& pose, const NearBodies& near, const JointVector& q,
                    const JointVector& velocity, double period_s) const noexcept;

  /// Of a velocity that is finite and within the limits of the limiter what may pass.
  void holdBack(const ChainPose& pose, const NearBodies& near, const JointVector& q,
                const JointVector& velocity_before, double period_s,
                JointVector& velocity) const noexcept;

 private:
  /// Of all that is near: where it shall be at least, and 1 / time to it.
  struct Pace {
    double least_m, rate_per_s;
  };
  struct ApproachRange {
    double v_max_m_per_s, presence;
  };
  Pace pace(const JointVector& q, const JointVector& velocity_before,
            double period_s) const noexcept;
  bool staysWithinLimits(const JointVector& q, const JointVector& velocity,
                         double time_s) const noexcept;
  ApproachRange range(const NearBody& body, const Pace& pace) const noexcept;

  ClearanceConfig config_;
  JointLimits limits_;
  BodyDistances distances_;
  StoppingWays ways_;
  double reach_m_;
  double margin_m_;
};

}  // namespace tactus
