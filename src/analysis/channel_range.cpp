#include "tactus/analysis/channel_range.h"

#include <algorithm>

#include "tactus/analysis/channel_window.h"
#include "tactus/sim/channel_shares.h"

namespace tactus {

double railForce_N(const TactileChannels& channels, double length_m) {
  const Eigen::Matrix<double, 8, 5> P = channelShares(channels);
  double largest_share = 0.0;  // of a channel in a force
  for (const double x_m : {0.0, length_m}) {
    const Eigen::Matrix<double, 8, 1> along_y = P.col(0) + x_m * P.col(3);
    const Eigen::Matrix<double, 8, 1> along_z = P.col(1) - x_m * P.col(2);
    const Eigen::Array<double, 8, 1> shares =
        (along_y.array().square() + along_z.array().square()).sqrt();
    largest_share = std::max(largest_share, shares.maxCoeff());
  }
  return kChannelEnd / (channels.counts_per_N * largest_share);
}

}  // namespace tactus
