#pragma once

#include "tactus/control/tactile_channels.h"

namespace tactus {

/// What each channel takes of (F_y, F_z, M_y, M_z, M_x), N: the smallest channels that make it up,
/// C^T (C C^T)^-1, for a calibration of full rank; the loader accepts no other. The column of M_x
/// is zero where it is not told.
Eigen::Matrix<double, 8, 5> channelShares(const TactileChannels& channels);

}  // namespace tactus
