#pragma once

#include "tactus/control/contact_point.h"
#include "tactus/control/controller_config.h"
#include "tactus/math/filter.h"

namespace tactus {

struct ContactSmootherState {
  /// 6 sigma of the force's noise: a smaller change means nothing; 0: no sample yet. N
  double significant_N = 0.0;
  Vector3 force_before_N = Vector3::Zero();      ///< of the newest sample
  Vector3 force_two_before_N = Vector3::Zero();  ///< and of the one before it
  double peak_N = 0.0;                           ///< of the last moments
  double weight = 0.0;                           ///< sum of the weights of all samples, N^2
  Pose X_BaseModule;                             ///< at the newest sample
  ContactPointState contact;  ///< force as read, but for rebounds; point and direction smooth
  KnownLagShare ringing, smoothing;
};

// clang-format off: equations
/// Keeps the noise of the sensor out of point x and direction F^ of contact. With them wrong by an
/// angle theta, motion along the cover at v looks like approach at theta v, and on a contact of
/// 1e5 N/m 10 um of that are 1 N.
/// Noise is told from signal by the second difference d2 of the force: the module's filter makes it
/// small for every real force. Its median is 2.88 sigma for noise alone, tracked by
///   s = 6 sigma:  s rises by 1 % if |d2| > 0.48 s, and else falls by 1 %;  at least s_min
/// x and F^ are means of the samples of the last T_s = 1 s, weighed by F^2 as their errors go with
/// 1 / F, of a contact whose place on the cover, x - r F^, stands still in the base frame while its
/// normal stays across the link's axis u: first the motion of the link since the sample before is
/// taken out of them. How the normal turns about u then, none of that tells: they are forgotten by
/// du, too, with theta_s = 0.05 rad. In an impact, where F grows by a fifth from one sample to
/// the next, the newest is all that counts; and a difference d from the mean that is larger than s,
/// measured as a force, is followed at once:
///   W = W exp(-dt / T_s) / (1 + |du| / theta_s) + F^2,   g = 1 - (1 - F^2 / W) min(1, (s / d)^2),
///   d = F |(dF^, dx / (L / 2))|,   x += g dx,  F^ += g dF^
/// With friction mu the force of one contact tilts by up to atan mu to either side as the link
/// slides, and x by mu r: what stays within both,
///   |dF^| < 2 sin atan mu,  |dx| < 2 mu r
/// is no other contact, hence averaged however large, in an impact, too. A law that followed it
/// would answer its own sliding, late by the filter.
/// One of several contacts has T_s = 4 s, and rests where its force is F_th, so noise takes it
/// below that at any time: all above the mean of F_rel and F_th counts there, and an impact is what
/// also grows by more than 2 s. For one contact alone:
/// A force up to F_th says nothing of either. After a blow the module's filter swings through and
/// shows up to 12 % of it from the other side: such a reading counts as no force. So does all from
/// the other side that is below 0.35 of the highest force, which is forgotten with 1.5 / f_c. With
/// friction nothing below that says anything of x and F^, from whatever side.
// clang-format on
class ContactSmoother {
 public:
  /// friction_coefficient: mu, 0 for none.
  ContactSmoother(const TactileModuleConfig& module, double friction_coefficient,
                  bool is_one_of_several = false);

  ContactSmootherState initialState() const noexcept;

  /// Takes over a new reading of the sensor; the result is state.contact. Of the gains, s_min is
  /// estimator.min_force_change_N.
  void update(const ForceGains& gains, const ContactPointState& sensor, const Pose& X_BaseModule,
              ContactSmootherState& state) const noexcept;

 private:
  /// Keeps the peak, too.
  bool isRebound(const ContactPointState& sensor, ContactSmootherState& state) const noexcept;

  bool isOfBlow(const ContactPointState& sensor, const ContactSmootherState& state) const noexcept;

  bool isImpact(double force_N, const ContactSmootherState& state) const noexcept;

  double half_length_m_, radius_m_;
  double ringing_s_;
  double max_turn_;  ///< of the unit force, by sliding
  double max_shift_m_;
  bool is_one_of_several_;
};

}  // namespace tactus
