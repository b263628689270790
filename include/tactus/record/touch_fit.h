#pragma once

#include <cstdint>
#include <deque>

#include "tactus/control/controller_config.h"
#include "tactus/supervisor/cycle_record.h"

namespace tactus {

/// What is kept of a cycle to tell how stiff a contact is.
struct TouchSample {
  double t_s = 0.0, force_N = 0.0, position_m = 0.0;
  Vector3 direction = Vector3::Zero();  ///< F^, module frame
  Vector3 way = Vector3::Zero();        ///< of this sample's force, likewise; may be of any length
  std::uint64_t sequence = 0;           ///< of the sample of the force
  double q[kMaxJoints] = {};            ///< as measured, m or rad
};

TouchSample touchSample(const CycleRecord& record, int module) noexcept;

/// How stiff a contact is, as its force says over the way of the contact point into it.
struct TouchFit {
  bool is_known = false;  ///< false: force or way do not tell; then all below is 0
  double stiffness_N_per_m = 0.0;
  double low_N_per_m = 0.0;  ///< interval of 95 %, at least 0
  double high_N_per_m = 0.0;
  double touch_s = 0.0;        ///< where the force began
  double speed_m_per_s = 0.0;  ///< towards the obstacle in the 50 ms before, may be negative
};

inline constexpr double kBeforeTouch_s = 0.6;  ///< that a fit looks at
inline constexpr double kBehindTouch_s = 0.6;

// clang-format off: equations
/// Least squares of F_sen = c_e LP(max(0, x - x_0)) in stiffness c_e and place of touch x_0, over
/// the new samples from 0.6 s before felt_s to 0.6 s behind it. x is the way of the contact point
/// against F^, by the measured joints, at each cycle where the force then says it acts:
///   dx = -F^^T (p(q_k) - p(q_k-1)),   p: the point of the module's axis there
/// before felt_s where it acted then, and where it is less than a quarter of that, or points away,
/// where it acted last; so x hardly notices that a contact slides along the link. LP is the nominal
/// filter of the module. F_sen is a size: it counts with the sign of its part along that F^, for
/// else the noise of a free module would be a force, and so would be what the filter swings back
/// when a contact bounces. c_e has all in it that gives way between the measured joints
/// and the world: obstacle and cover, and gears where the drives measure motors. The interval
/// is 1.96 standard deviations of the linearised fit; as neighbouring residuals are alike, they
/// count as 2 f_c independent ones a second; with 3 % for errors in the way itself. Unknown
/// of fewer than 10 samples or 0.5 N, of cycles that are missing, of samples that begin less than
/// 50 ms before felt_s, as a log that begins in contact, of a contact within 2 mm of the cover's
/// ends, where F^ need not be the normal, and where the deviation is above half of c_e. felt_s:
/// F_sen is above F_th from there on. Costs some milliseconds.
// clang-format on
TouchFit fitTouch(const ControllerConfig& config, int module,
                  const std::deque<TouchSample>& samples, double felt_s);

}  // namespace tactus
