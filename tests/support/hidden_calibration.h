#pragma once

#include <Eigen/SVD>

#include "support/random.h"
#include "tactus/control/tactile_channels.h"

namespace tactus::test {

/// F_y, F_z, M_y, M_z, M_x of a module of 0.38 m with a radius of 0.06 m, whose cells are anywhere.
using HiddenRows = Eigen::Matrix<double, 5, 8>;

/// Of one that is not badly built: its cells tell every row, none ten times better than another.
inline HiddenRows hiddenCalibration(Random& random) {
  while (true) {
    HiddenRows C;
    for (double& c : C.reshaped()) c = random.uniform(-1.0, 1.0);
    const Wrench5 scale{{1.0, 1.0, 0.19, 0.19, 0.06}};
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd{Eigen::MatrixXd(C)};
    if (svd.singularValues()[0] < 10.0 * svd.singularValues()[4]) return scale.asDiagonal() * C;
  }
}

inline TactileChannels channelsWith(const HiddenRows& C, int rows) {
  TactileChannels channels;
  channels.calibration = C.topRows<4>();
  if (rows == 5) channels.moment_x = C.row(4);
  return channels;
}

}  // namespace tactus::test
