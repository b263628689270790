#pragma once

#include "tactus/control/contact_point.h"

namespace tactus {

struct ContactSmootherState {
  /// 6 sigma of the force's noise: a smaller change means nothing. N
  double significant_N = 0.0;
  Vector3 force_before_N = Vector3::Zero();      ///< of the newest sample
  Vector3 force_two_before_N = Vector3::Zero();  ///< and of the one before it
  double weight = 0.0;                           ///< sum of the weights of all samples, N^2
  ContactPointState contact;                     ///< force as read, point and direction smooth
};

// clang-format off: equations
/// Keeps the noise of the sensor out of point x and direction F^ of contact. With them wrong by an
/// angle theta, motion along the cover at v looks like approach at theta v, and on a contact of
/// 1e5 N/m 10 um of that are 1 N.
/// Noise is told from signal by the second difference d2 of the force: the module's filter makes it
/// small for every real force. Its median is 2.88 sigma for noise alone, tracked by
///   s = 6 sigma:  s rises by 1 % if |d2| > 0.48 s, and else falls by 1 %;  at least s_min
/// A sample moves x and F^ by the share g of the difference. Smaller than s, measured as a force,
/// it is smoothed with T_s = 0.2 s; what is larger is followed at once:
///   g = max(g_s, 1 - (1 - g_s) (s / d)^2),   d = F |(dF^, dx / (L / 2))|
/// A force below s says nothing of either.
// clang-format on
class ContactSmoother {
 public:
  /// min_significant_N: s_min; link_length_m: L, of the cover.
  ContactSmoother(double min_significant_N, double link_length_m)
      : min_significant_N_(min_significant_N), half_length_m_(0.5 * link_length_m) {}

  ContactSmootherState initialState() const noexcept;

  /// Takes over a sensor's reading; the result is state.contact.
  void update(const ContactPointState& sensor, ContactSmootherState& state) const noexcept;

 private:
  void learnNoise(const Vector3& force_N, ContactSmootherState& state) const noexcept;

  double min_significant_N_;
  double half_length_m_;
};

}  // namespace tactus
