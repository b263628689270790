#pragma once

#include "tactus/control/contact_point.h"

namespace tactus {

struct ContactSmootherState {
  /// 6 sigma of the force's noise: a smaller change means nothing. N
  double significant_N = 0.0;
  Vector3 force_before_N = Vector3::Zero();      ///< of the newest sample
  Vector3 force_two_before_N = Vector3::Zero();  ///< and of the one before it
  Vector3 force_N = Vector3::Zero();             ///< smooth
  double magnitude_N = 0.0, leverage_Nm = 0.0;   ///< likewise: F and F x
  ContactPointState contact;                     ///< force as read, point and direction smooth
};

// clang-format off: equations
/// Keeps the noise of the sensor out of point and direction of contact. With them wrong by an angle
/// theta, motion along the cover at v looks like approach at theta v, and on a contact of 1e5 N/m
/// 10 um of that are 1 N.
/// Noise is told from signal by the second difference d2 of the force: the module's filter makes it
/// small for every real force. Its median is 2.88 sigma for noise alone, tracked by
///   s = 6 sigma:  s rises by 1 % if |d2| > 0.48 s, and else falls by 1 %;  at least s_min
/// Force, and force times position, are smoothed with T_s = 0.2 s as long as they differ from the
/// sample by less than s, and follow at once what differs by more:
///   F += g (F_sample - F),  g = max(g_s, 1 - (1 - g_s) (s / |F_sample - F|)^2)
// clang-format on
class ContactSmoother {
 public:
  /// min_significant_N: s_min.
  explicit ContactSmoother(double min_significant_N) : min_significant_N_(min_significant_N) {}

  ContactSmootherState initialState(double position_m) const noexcept;

  /// Takes over a sensor's reading; the result is state.contact.
  void update(const ContactPointState& sensor, ContactSmootherState& state) const noexcept;

 private:
  void learnNoise(const Vector3& force_N, ContactSmootherState& state) const noexcept;

  double min_significant_N_;
};

}  // namespace tactus
