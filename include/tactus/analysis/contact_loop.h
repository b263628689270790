#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

#include "tactus/analysis/geared_contact.h"

namespace tactus {

/// What answers the contact force.
enum class LoopLaw {
  kOneSpace,       ///< (5): one space takes all of the contact's motion
  kTwoSpaces,      ///< (5) and (7) at once, both not at their limits: the gain of one, twice
  kApproachLimit,  ///< docs/approach_speed_limit.md, while something presses on; first order
};

/// The contact of one point with a spring as a linear loop, in the order of Controller and
/// SimulatedRobot: a sample of the filtered force is held, each cycle the law answers with a
/// velocity, the drives integrate it and lag behind, the spring answers, the filter steps.
struct ContactLoop {
  LoopLaw law = LoopLaw::kOneSpace;
  bool is_acceleration = false;   ///< the second level of control, of all three laws
  int order = 2;                  ///< of the target dynamics (4): 1 or 2
  double time_constant_s = 0.1;   ///< T
  double damping = 0.5;           ///< d, second order only
  double drift_gain_per_s = 0.0;  ///< beta, as far as it reaches the contact; see below

  double period_s = 0.001;          ///< of the cycle
  double drive_lag_s = 0.005;       ///< first order, of the position; 0: ideal
  double filter_cutoff_hz = 15.0;   ///< 3rd-order Butterworth
  double filter_rate_hz = 1000.0;   ///< its period is a multiple or a whole part of the cycle's
  double sample_period_s = 0.004;   ///< a multiple of the filter's period
  bool filters_at_samples = false;  ///< the filter runs once a sample, behind the sampler

  double answer_lag_s = 0.0;  ///< 1/k_v: of feedforward and approach limit, acceleration level

  // What the approach-speed limit takes drives and filter for.
  double model_drive_lag_s = 0.005;
  double model_filter_cutoff_hz = 15.0;

  /// An arm with mass, in place of drive_lag_s; for one space, whose tool stays where it is.
  std::optional<GearedContact> geared{};
};

// clang-format off: equations
/// All lengths along the contact force, forces divided by the assumed stiffness c, so that the
/// stiffness ratio c_e / c is all that remains of both:
///   f = -(c_e / c) x                                    x: displacement away from the obstacle
///   v = n (P c f_held + W) - beta z,  W += dt f_held / T^2,  z += dt (P c f_held + W - beta z)
/// with n = 1 or 2 spaces. The offsets F_th and F_act move the point of rest and nothing else. In
/// two spaces V and I of the two laws grow by the same, W; their difference never comes back into
/// the loop (above F_act it drifts: the paper's "not asymptotically stable", IV-B).
/// z is how far the law has taken the tool from its path; beta pulls it back, and the contact with
/// it. In the one-space loop the law is then that of the task space. Where the feedforward of (5)
/// takes this motion out of the contact, as it does while the pull is towards the obstacle, beta is
/// 0 here.
///
/// At the acceleration level
///   v += n (dt f_held / T^2 - D v) - beta z_dot dt,   D = 1 - exp(-2 d dt / T)
/// where the pull on the tool goes to its speed z_dot; the approach limit is reached with a lag.
///
/// The approach-speed limit predicts with c what the sample does not show yet, from x_f, what its
/// model of drives and filter made of x by the time of the sample: f_held + x_f - x takes the place
/// of f_held.
///
/// The loop runs at several rates, so it is lifted: what one common period of cycle and sample
/// makes of the state is a constant matrix, and the loop is stable where its eigenvalues are inside
/// the unit circle. Nothing is approximated.
///
/// With masses and gears x is that of the links, which motors move as GearedContact says, and c_e
/// bends the gears, too: there the ratio alone does not tell, and c counts.
// clang-format on
using LoopState = Eigen::Matrix<std::complex<double>, 1, Eigen::Dynamic>;
using LoopMatrix = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic>;

/// Steps of the plant in a common period; 0 if there are too many (more than 10000) to be lifted,
/// or if the rates do not fit each other.
int stepsOfCommonPeriod(const ContactLoop& loop);

/// What one common period makes of the state. The loop's sample is turned back by phase_lag_rad,
/// which a loop with a larger phase margin survives. Needs stepsOfCommonPeriod(loop) > 0.
LoopMatrix commonPeriodMatrix(const ContactLoop& loop, double stiffness_ratio,
                              double phase_lag_rad = 0.0);

/// All eigenvalues inside the unit circle?
bool isStable(const ContactLoop& loop, double stiffness_ratio, double phase_lag_rad = 0.0);

}  // namespace tactus
