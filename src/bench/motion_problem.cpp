#include "tactus/bench/motion_problem.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "tactus/bench/random.h"

namespace tactus {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

LongMatrix randomMatrix(BenchRandom& random, int rows, int columns) {
  LongMatrix A(rows, columns);
  for (int i = 0; i < rows * columns; ++i) A.data()[i] = random.uniform(-1.0, 1.0);
  return A;
}

LongMatrix randomOrthogonal(BenchRandom& random, int size) {
  return Eigen::HouseholderQR<LongMatrix>(randomMatrix(random, size, size)).householderQ();
}

}  // namespace

std::vector<MotionProblem<double>> randomProblems(int count, int task_size, int joints,
                                                  double ratio) {
  BenchRandom random(20240229);
  std::vector<MotionProblem<double>> problems(count);
  for (MotionProblem<double>& problem : problems) {
    LongMatrix S = LongMatrix::Zero(task_size, joints);
    for (int i = 0; i < task_size; ++i)
      S(i, i) = task_size == 1 ? 1.0 : std::pow(ratio, static_cast<double>(i) / (task_size - 1));
    const LongMatrix U = randomOrthogonal(random, task_size);
    const LongMatrix V = randomOrthogonal(random, joints);
    problem.J = (U * S * V).cast<double>();
    problem.w = randomMatrix(random, task_size, 1).col(0).normalized().cast<double>();
    problem.v = randomMatrix(random, joints, 1).col(0).normalized().cast<double>();
  }
  return problems;
}

MotionParts<long double> referenceSolution(const MotionProblem<double>& problem) {
  const LongMatrix J = problem.J.cast<long double>();
  const Eigen::JacobiSVD<LongMatrix> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const LongMatrix& V = svd.matrixV();
  const LongVector y = svd.matrixU().transpose() * problem.w.cast<long double>();
  const LongVector v = problem.v.cast<long double>();
  const LongVector x = V * y.cwiseQuotient(svd.singularValues());
  const LongVector null = v - V * (V.transpose() * v);
  return {x, null};
}

}  // namespace tactus
