#pragma once

#include <optional>

#include "tactus/math/types.h"

namespace tactus {

/// Force and moment (F_y, F_z, M_y, M_z, M_x) in the module's frame, N and Nm. Not all modules tell
/// M_x.
using Wrench5 = Eigen::Matrix<double, 5, 1>;

/// One number a channel of a tactile module.
using TactileChannelRow = Eigen::Matrix<double, 1, 8>;

/// What the eight channels of a tactile module mean, and how often it sends them.
struct TactileChannels {
  /// (F_y, F_z, M_y, M_z) in the module's frame from the channels in N, m; rank 4.
  Eigen::Matrix<double, 4, 8> calibration = Eigen::Matrix<double, 4, 8>::Zero();
  std::optional<TactileChannelRow> moment_x{};  ///< M_x likewise, independent of the others, m
  double counts_per_N = 100000.0;               ///< of the 24-bit channels
  double sample_period_s = 0.004;  ///< of a simulated module a multiple of its filter's period
};

}  // namespace tactus
