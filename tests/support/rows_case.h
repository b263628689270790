#pragma once

#include "support/expanded_pseudoinverse.h"
#include "support/random_jacobian.h"
#include "support/random_robot.h"
#include "tactus/control/speed_rows.h"

namespace tactus::test {

/// Rows and a motion of a random robot, and what both mean in joints.
struct RowsCase {
  RowsCase(Random& random, int count)
      : n(random.integer(4, kMaxJoints)),
        m(random.integer(1, std::min(n - 1, kMaxTaskSize))),
        weights(randomWeights(random, n)),
        inv_sqrt(inverseSquareRoot(weights)),
        inverse(expandPseudoinverse(
            randomJacobian(random, randomSpectrum(random, m, 0.1, 5.0), weights), weights)) {
    rows.size = count;
    for (int i = 0; i < count; ++i) {
      setRow(i, random.vector(n, -1.0, 1.0));
      rows.row[i].v_max_m_per_s = random.uniform(-0.2, 0.5);
      rows.row[i].damping_N_s_per_m = random.logUniform(10.0, 1e5);
      rows.row[i].presence = 1.0;
    }
    motion.v_scaled = scaled(random.vector(n, -1.0, 1.0), ScaledVector::Ones());
    motion.y.setZero();
    for (int i = 0; i < m; ++i) motion.y[i] = random.uniform(-1.0, 1.0);
  }

  void setRow(int i, const JointVector& a) {
    if (A.rows() == 0) A = Eigen::MatrixXd::Zero(rows.size, n);
    A.row(i) = a;
    rows.row[i].a_scaled = scaled(a, inv_sqrt);
    rows.row[i].a_task = inverse.factors.project(rows.row[i].a_scaled);
  }

  Eigen::VectorXd joints(const Motion& of) const {
    const ScaledVector v = of.v_scaled + inverse.factors.expand(of.y);
    return v.cwiseProduct(inv_sqrt).head(n);
  }

  int n, m;
  JointVector weights;
  ScaledVector inv_sqrt;
  ExpandedPseudoinverse inverse;
  SpeedRows rows;
  Eigen::MatrixXd A;
  Motion motion;
};

}  // namespace tactus::test
