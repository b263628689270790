#include "tactus/bench/pseudoinverse_methods.h"
#include "tactus/math/weighted_pseudoinverse.h"

namespace tactus {
namespace {

using Problem = MotionProblem<double>;

ScaledVector noWeights(Eigen::Index joints) {
  ScaledVector ones = ScaledVector::Zero();
  ones.head(joints).setOnes();
  return ones;
}

/// J times `scale`, for which J# w is divided by it and N v stays the same.
void solveOurs(const Problem& problem, double scale, MotionParts<double>& parts) {
  const auto n = problem.J.cols();
  const ScaledVector inv_sqrt_weights = noWeights(n);
  const TaskJacobian J = scale * problem.J;
  WeightedPseudoinverse factors;
  factors.factorise(J, inv_sqrt_weights);
  const ScaledVector v = scaled(problem.v, inv_sqrt_weights);
  const ScaledVector task = factors.expand(factors.solve(problem.w));
  const ScaledVector null = v - factors.expand(factors.project(v));
  parts.task = scale * task.head(n).cwiseProduct(inv_sqrt_weights.head(n));
  parts.null = null.head(n).cwiseProduct(inv_sqrt_weights.head(n));
}

/// A power of two changes no digit, and lifts even singular values of 1e-12 over the threshold
/// below which an arm's are damped.
void solveOursExactly(const Problem& problem, MotionParts<double>& parts) {
  solveOurs(problem, 0x1p40, parts);
}

void solveOursDamped(const Problem& problem, MotionParts<double>& parts) {
  solveOurs(problem, 1.0, parts);
}

}  // namespace

std::vector<PseudoinverseMethod<double>> ourMethods() {
  return {{"ours", false, solveOursExactly}, {"ours, damped", true, solveOursDamped}};
}

}  // namespace tactus
