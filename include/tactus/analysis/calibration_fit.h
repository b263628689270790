#pragma once

#include <optional>
#include <vector>

#include "tactus/analysis/channel_window.h"
#include "tactus/control/gains.h"
#include "tactus/control/tactile_channels.h"

namespace tactus {

/// A known push on the cover of a tactile module, and what the channels made of it. Force on the
/// robot, module's frame: x along the link.
struct KnownPush {
  double force_y_N = 0.0, force_z_N = 0.0;
  double position_m = 0.0;                       ///< along x
  double moment_x_Nm = 0.0;                      ///< about the link's axis, beside the force
  ChannelVector counts = ChannelVector::Zero();  ///< less those without load
};

/// (F_y, F_z, M_y, M_z, M_x) of a push: M_y = -x F_z, M_z = x F_y.
Wrench5 wrenchOf(const KnownPush& push) noexcept;

/// What a calibration is for.
struct CalibratedModule {
  double counts_per_N = 0.0;
  double length_m = 0.0, cover_radius_m = 0.0;
};

/// How far a push is from what a calibration says of its counts.
struct PushResidual {
  double force_N = 0.0;     ///< |dF|
  double position_m = 0.0;  ///< of the place along x; NaN where the calibration finds no force
  /// |(dF_y, dF_z, dM_y/l, dM_z/l, dM_x/r)| by the push's size, l half the length, r the radius.
  double share = 0.0;
};

/// Why there is no calibration.
enum class CalibrationProblem { kNone, kTooFew, kPushesAlike, kChannelsAlike };

struct CalibrationFit {
  CalibrationProblem problem = CalibrationProblem::kNone;
  int rows = 4;  ///< 5 if a push has a moment about x
  /// Of the pushes, each by its size and moments by l and r: largest to smallest singular value.
  double pushes_condition = kNoLimit;
  /// Of F_y, F_z, M_y, M_z, M_x, that they tell least; M_y, M_z: where F_z, F_y is told, but at
  /// nearly one place.
  int weakest_row = 0;
  double channels_condition = kNoLimit;  ///< of the counts, likewise
  Eigen::Matrix<double, 5, 8> calibration = Eigen::Matrix<double, 5, 8>::Zero();
  std::vector<PushResidual> residuals;  ///< one a push
  /// By the calibration of all other pushes; absent where these are too few or too alike: nothing
  /// checks such a push.
  std::vector<std::optional<PushResidual>> left_out;
  Wrench5 noise = Wrench5::Zero();  ///< sigma of each row, N and Nm, of the channels without load
  int worst = -1;                   ///< the push whose absence makes the others agree best
  int or_worst = -1;                ///< another of which that is hardly less true; -1: none
};

/// Beyond it the weakest row would be made of the errors of the pushes.
inline constexpr double kMaxPushesCondition = 20.0;
inline constexpr double kMaxChannelsCondition = 200.0;
/// A push that is off the others by more is a wrong entry: of its force, or of l as to its place.
inline constexpr double kMaxLeftOutShare = 0.15;

/// The calibration C with C s_i = w_i for the channels s_i of all pushes, by least squares: each
/// push counts by its size, as errors of place and direction grow with it. Of the channels only as
/// many directions as there are rows are used, those of the largest singular values,
///   S = U diag(s) V^T,   C = W V_r diag(1/s_r) U_r^T
/// the others being noise; of all C that do the same for these, it is the smallest (Eckart and
/// Young 1936; Golub and Van Loan, Matrix Computations, 5.5). sigma: of the counts without load.
CalibrationFit fitCalibration(const std::vector<KnownPush>& pushes, const CalibratedModule& module,
                              const ChannelVector& sigma);

/// The push that is off the others by the largest share; -1: none can be judged.
int farthestPush(const CalibrationFit& fit) noexcept;

/// The push that is wrong, if any is off the others by more than kMaxLeftOutShare: the worst, or,
/// if that is not, the one that is off most. -1: none.
int wrongPush(const CalibrationFit& fit) noexcept;

/// Of the pushes alone, before there are counts: condition and weakest row; kNoLimit: too few.
double pushesCondition(const std::vector<KnownPush>& pushes, const CalibratedModule& module,
                       int* weakest_row = nullptr);

/// Likewise: how many there are without which the others do not tell each row, so that nothing
/// checks them.
int uncheckedPushes(const std::vector<KnownPush>& pushes, const CalibratedModule& module);

}  // namespace tactus
