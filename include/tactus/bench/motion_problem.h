#pragma once

#include <Eigen/Core>
#include <vector>

#include "tactus/math/types.h"

namespace tactus {

/// The motion equation (1) with W = I: what a pseudoinverse is for. In storage of fixed capacity
/// for every method, so that none pays for the heap.
template <typename Scalar>
struct MotionProblem {
  using Jacobian = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                 kMaxTaskSize, kMaxJoints>;
  using Task = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxTaskSize, 1>;
  using Joints = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;

  Jacobian J;  ///< m x n
  Task w;      ///< of the task
  Joints v;    ///< to be projected into the null space

  template <typename Other>
  MotionProblem<Other> cast() const {
    return {J.template cast<Other>(), w.template cast<Other>(), v.template cast<Other>()};
  }
};

template <typename Scalar>
struct MotionParts {
  typename MotionProblem<Scalar>::Joints task;  ///< J# w
  typename MotionProblem<Scalar>::Joints null;  ///< N v
};

/// `count` random problems with m = task_size: largest singular value 1, smallest `ratio`, between
/// them a geometric row; |w| = |v| = 1. The same for the same arguments.
std::vector<MotionProblem<double>> randomProblems(int count, int task_size, int joints,
                                                  double ratio);

/// The exact answer to a problem as its doubles stand, by a singular value decomposition in long
/// double. Its 11 more bits make its error 1/2048 of what any method in double can reach at the
/// same condition, down to singular values of 1e-12 and beyond.
MotionParts<long double> referenceSolution(const MotionProblem<double>& problem);

}  // namespace tactus
