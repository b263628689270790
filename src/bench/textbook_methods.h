#pragma once

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "tactus/bench/pseudoinverse_methods.h"

/// Definitions for the two sources that instantiate them, one a scalar: together they would take a
/// compiler 2 GB.
namespace tactus {
namespace {

template <typename Scalar>
using Problem = MotionProblem<Scalar>;
/// One type for all that is decomposed: each further one takes a compiler ten seconds.
template <typename Scalar>
using Decomposed =
    Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;

/// x = J^T (J J^T + lambda^2 I)^-1 w; with lambda the projector leaks into the task.
template <typename Scalar>
void solveByGram(const Problem<Scalar>& problem, Scalar lambda, MotionParts<Scalar>& parts) {
  const auto& J = problem.J;
  Decomposed<Scalar> gram = J.lazyProduct(J.transpose());
  gram.diagonal().array() += lambda * lambda;
  const Eigen::LLT<Decomposed<Scalar>> cholesky(gram);
  using Task = typename Problem<Scalar>::Task;
  const Task y = cholesky.solve(problem.w);
  const Task c = cholesky.solve(Task(J.lazyProduct(problem.v)));
  parts.task = J.transpose().lazyProduct(y);
  parts.null = problem.v - J.transpose().lazyProduct(c);
}

template <typename Scalar>
void solveNormalEquations(const Problem<Scalar>& problem, MotionParts<Scalar>& parts) {
  solveByGram<Scalar>(problem, Scalar(0), parts);
}

template <typename Scalar>
void solveDampedNormalEquations(const Problem<Scalar>& problem, MotionParts<Scalar>& parts) {
  solveByGram<Scalar>(problem, Scalar(kBenchDamping), parts);
}

/// J^T = Q R.
template <typename Scalar>
void solveHouseholder(const Problem<Scalar>& problem, MotionParts<Scalar>& parts) {
  const auto m = problem.J.rows();
  const Eigen::HouseholderQR<Decomposed<Scalar>> qr(problem.J.transpose());
  const auto R = qr.matrixQR().topRows(m).template triangularView<Eigen::Upper>();
  parts.task.setZero(problem.J.cols());
  parts.task.head(m) = R.transpose().solve(problem.w);
  parts.task.applyOnTheLeft(qr.householderQ());
  parts.null = problem.v;
  parts.null.applyOnTheLeft(qr.householderQ().transpose());
  parts.null.head(m).setZero();
  parts.null.applyOnTheLeft(qr.householderQ());
}

template <typename Scalar>
void solveOrthogonal(const Problem<Scalar>& problem, MotionParts<Scalar>& parts) {
  const Eigen::CompleteOrthogonalDecomposition<Decomposed<Scalar>> cod(problem.J);
  parts.task = cod.solve(problem.w);
  parts.null = problem.v - cod.solve(problem.J.lazyProduct(problem.v).eval());
}

template <typename Scalar>
void solveBySvd(const Problem<Scalar>& problem, Scalar lambda, MotionParts<Scalar>& parts) {
  using Task = typename Problem<Scalar>::Task;
  const Eigen::JacobiSVD<Decomposed<Scalar>> svd(problem.J,
                                                 Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& s = svd.singularValues().array();
  Task y = svd.matrixU().transpose().lazyProduct(problem.w);
  if (lambda > Scalar(0)) {
    y.array() *= s / (s.square() + lambda * lambda);
  } else {
    y.array() /= s;
  }
  const Task c = svd.matrixV().transpose().lazyProduct(problem.v);
  parts.task = svd.matrixV().lazyProduct(y);
  parts.null = problem.v - svd.matrixV().lazyProduct(c);
}

template <typename Scalar>
void solveSvd(const Problem<Scalar>& problem, MotionParts<Scalar>& parts) {
  solveBySvd<Scalar>(problem, Scalar(0), parts);
}

template <typename Scalar>
void solveDampedSvd(const Problem<Scalar>& problem, MotionParts<Scalar>& parts) {
  solveBySvd<Scalar>(problem, Scalar(kBenchDamping), parts);
}

}  // namespace

template <typename Scalar>
std::vector<PseudoinverseMethod<Scalar>> textbookMethods() {
  return {{"normal equations", false, solveNormalEquations<Scalar>},
          {"Householder QR", false, solveHouseholder<Scalar>},
          {"complete orthogonal", false, solveOrthogonal<Scalar>},
          {"Jacobi SVD", false, solveSvd<Scalar>},
          {"normal equations, damped", true, solveDampedNormalEquations<Scalar>},
          {"Jacobi SVD, damped", true, solveDampedSvd<Scalar>}};
}
}  // namespace tactus
