#pragma once

#include "tactus/math/types.h"

namespace tactus {

/// Force and moment (F_y, F_z, M_y, M_z) in the module's frame, N and Nm.
using Wrench4 = Eigen::Vector4d;

/// What the eight channels of a tactile module mean, and how often it sends them.
struct TactileChannels {
  /// (F_y, F_z, M_y, M_z) in the module's frame from the channels in N, m; rank 4.
  Eigen::Matrix<double, 4, 8> calibration = Eigen::Matrix<double, 4, 8>::Zero();
  double counts_per_N = 100000.0;  ///< of the 24-bit channels
  double sample_period_s = 0.004;  ///< of a simulated module a multiple of its filter's period
};

}  // namespace tactus
