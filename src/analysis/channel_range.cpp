#include "tactus/analysis/channel_range.h"

#include <Eigen/LU>
#include <algorithm>

#include "tactus/analysis/channel_window.h"

namespace tactus {

double railForce_N(const TactileChannels& channels, double length_m) {
  Eigen::MatrixXd C = channels.calibration;
  if (channels.moment_x) {
    C.conservativeResize(5, Eigen::NoChange);
    C.row(4) = *channels.moment_x;
  }
  const Eigen::MatrixXd P = C.transpose() * (C * C.transpose()).inverse();
  double largest_share = 0.0;  // of a channel in a force
  for (const double x_m : {0.0, length_m}) {
    const Eigen::MatrixXd along_y = P.col(0) + x_m * P.col(3);
    const Eigen::MatrixXd along_z = P.col(1) - x_m * P.col(2);
    const Eigen::ArrayXXd shares = (along_y.array().square() + along_z.array().square()).sqrt();
    largest_share = std::max(largest_share, shares.maxCoeff());
  }
  return kChannelEnd / (channels.counts_per_N * largest_share);
}

}  // namespace tactus
