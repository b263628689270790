#pragma once

#include "tactus/control/controller_config.h"
#include "tactus/math/filter.h"

namespace tactus {

/// Joint positions, zero beyond the robot's joints; m or rad, relative to `origin`.
struct SensedPositionState {
  bool has_started = false;
  JointVector origin;                             ///< where the first cycle was
  ScaledVector commanded = ScaledVector::Zero();  ///< q_d
  ScaledVector lagged = ScaledVector::Zero();     ///< q_l: the drives follow
  ScaledVector s0 = ScaledVector::Zero();         ///< of the filter, direct form II transposed
  ScaledVector s1 = ScaledVector::Zero();
  ScaledVector s2 = ScaledVector::Zero();
  ScaledVector sensed = ScaledVector::Zero();         ///< q_f at the newest force sample
  ScaledVector sensed_before = ScaledVector::Zero();  ///< and at the one before it
  KnownLagShare drive_lag;
};

/// Where the arm was, as the force sample tells it: the desired joints through the nominal lag of
/// the drives and the nominal filter of the tactile module, kept when a sample arrives. A force and
/// this position are late by the same, so that their quotient is the stiffness also while the arm
/// accelerates, and q_d - q_f is the way that no sample has told of yet.
class SensedPosition {
 public:
  SensedPosition(double drive_lag_s, double filter_cutoff_hz)
      : drive_lag_s_(drive_lag_s), filter_cutoff_hz_(filter_cutoff_hz) {}

  /// q_desired: at the start of the cycle, all earlier commands done; is_new_sample: a force sample
  /// has arrived since the last cycle.
  void update(const JointVector& q_desired, bool is_new_sample, double period_s,
              SensedPositionState& state) const noexcept;

 private:
  double drive_lag_s_;
  double filter_cutoff_hz_;
};

}  // namespace tactus
