#pragma once

#include "tactus/control/contact_smoother.h"

namespace tactus {

/// What is known of where the stiffness of a module's contacts is. Places are on the cover, base
/// frame, m.
struct StiffnessCentreState {
  bool has_reference = false;
  Vector3 F_BaseRef = Vector3::Zero();  ///< an earlier reading, N
  Vector3 p_BaseRef = Vector3::Zero();  ///< and its place
  double since_s = 0.0;                 ///< that reading
  Vector3 p_Base = Vector3::Zero();     ///< the centre
  double weight = 0.0;                  ///< sum of dF^2 behind it, N^2; 0: nothing is known
  double shift_m = 0.0;                 ///< along x from the smoother's contact to it, beyond doubt
};

// clang-format off: equations
/// Where two contacts press on one module, M / F is the centre of their forces. How F changes is
/// told at another place: a link that approaches them at v(x) changes their sum by
///   dF/dt = (c_1 + c_2) v(x_c),   x_c = (c_1 x_1 + c_2 x_2) / (c_1 + c_2)
/// At x_c changes of the force act: dM = x_c dF. From each pair of readings that differ by
///   |dF| > max(s, F / 10),   s: 6 sigma of the force's noise, see contact_smoother.h
/// with contacts that stand still in the base frame,
///   x = (M - M_ref) / dF within the cover,   W <- min(W, 30 s^2) + dF^2,   x_c += dF^2 / W (x -
///   x_c)
/// All along the smoothed direction F^. If the link turns meanwhile, x is not x_c, but a place that
/// approaches the faster, never slower: a limit there holds at x_c, too.
/// One contact has x_c = M / F. What is less than a centimetre, mu r and half a length times
/// s / sqrt W away from that is no second contact.
/// A reading that is a second old is replaced: slow changes are friction and drift. Of readings up
/// to F_th nothing is learnt.
// clang-format on
class StiffnessCentre {
 public:
  /// friction_coefficient: mu, 0 for none.
  StiffnessCentre(const TactileModuleConfig& module, double friction_coefficient);

  /// A new reading, which the smoother has seen.
  void update(const ForceGains& gains, const ContactPointState& sensor,
              const ContactSmootherState& smoother, StiffnessCentreState& state) const noexcept;

 private:
  double shift_m(const ContactSmootherState& smoother,
                 const StiffnessCentreState& state) const noexcept;

  double length_m_, radius_m_;
  double least_shift_m_;
};

}  // namespace tactus
