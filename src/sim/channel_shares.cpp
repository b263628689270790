#include "tactus/sim/channel_shares.h"

#include <Eigen/LU>

namespace tactus {
namespace {

template <int kRows>
Eigen::Matrix<double, 8, kRows> pseudoinverse(const Eigen::Matrix<double, kRows, 8>& C) {
  const Eigen::Matrix<double, kRows, kRows> gram = C * C.transpose();
  return C.transpose() * gram.inverse();
}

}  // namespace

Eigen::Matrix<double, 8, 5> channelShares(const TactileChannels& channels) {
  Eigen::Matrix<double, 8, 5> shares = Eigen::Matrix<double, 8, 5>::Zero();
  if (!channels.moment_x) {
    shares.leftCols<4>() = pseudoinverse(channels.calibration);
    return shares;
  }
  Eigen::Matrix<double, 5, 8> C;
  C << channels.calibration, *channels.moment_x;
  shares = pseudoinverse(C);
  return shares;
}

}  // namespace tactus
