#include "tactus/bench/pseudoinverse_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tactus/bench/pseudoinverse_methods.h"

namespace tactus {
namespace {

using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Twice modified Gram-Schmidt on J^T in long double: another way to the reference.
LongMatrix orthonormalRows(LongMatrix J) {
  for (int i = 0; i < J.rows(); ++i) {
    for (int pass = 0; pass < 2; ++pass)
      for (int k = 0; k < i; ++k) J.row(i) -= J.row(k).dot(J.row(i)) * J.row(k);
    J.row(i).normalize();
  }
  return J;
}

TEST(Reference, SolvesTheTaskAndProjectsToTheBitsItPromises) {
  for (const int m : {3, 6}) {
    for (const double ratio : {1.0, 1e-6, 1e-12}) {
      for (const MotionProblem<double>& problem : randomProblems(5, m, 9, ratio)) {
        const MotionParts<long double> parts = referenceSolution(problem);
        const LongMatrix J = problem.J.cast<long double>();
        const LongMatrix Q = orthonormalRows(J);
        const LongVector v = problem.v.cast<long double>();
        const LongVector null = v - Q.transpose() * (Q * v);
        const auto eps = static_cast<double>(1e-17L / ratio);
        EXPECT_LT(static_cast<double>((parts.null - null).norm()), eps);
        const LongVector w = problem.w.cast<long double>();
        EXPECT_LT(static_cast<double>((J * parts.task - w).norm()), eps);
        const LongVector outside = parts.task - Q.transpose() * (Q * parts.task);
        EXPECT_LT(static_cast<double>(outside.norm() / parts.task.norm()), eps);
      }
    }
  }
}

template <typename Scalar>
void expectAgreement(const std::vector<PseudoinverseMethod<Scalar>>& methods, double tolerance) {
  for (const PseudoinverseMethod<Scalar>& method : methods) {
    if (method.is_damped && method.name != "ours, damped") continue;
    for (const int m : {1, 3, 6}) {
      for (const MotionProblem<double>& problem : randomProblems(5, m, 9, 0.1)) {
        const MotionParts<long double> exact = referenceSolution(problem);
        MotionParts<Scalar> parts;
        method.solve(problem.cast<Scalar>(), parts);
        const auto task = (parts.task.template cast<long double>() - exact.task).norm();
        const auto null = (parts.null.template cast<long double>() - exact.null).norm();
        EXPECT_LT(static_cast<double>(task), tolerance) << method.name << m;
        EXPECT_LT(static_cast<double>(null), tolerance) << method.name << m;
      }
    }
  }
}

TEST(PseudoinverseMethods, AgreeAwayFromSingularities) {
  expectAgreement(textbookMethods<double>(), 1e-12);
  expectAgreement(textbookMethods<float>(), 1e-3);
  expectAgreement(ourMethods(), 1e-12);
}

TEST(PseudoinverseStudy, OursIsAsExactAsAnSvdWhereNormalEquationsFail) {
  PseudoinverseSizes sizes;
  sizes.decades = 6;
  sizes.problems = 16;
  sizes.batches = 1;
  const Table table = measurePseudoinverses(sizes);
  ASSERT_EQ(table.rows.size(), 2u * 7u * (2u + 6u + 6u));
  for (const double m : {3.0, 6.0}) {
    const auto error = [&](const char* method, const char* column) {
      return findNumber(table, column,
                        {{"method", std::string(method)},
                         {"scalar", std::string("double")},
                         {"task_components", m},
                         {"singular_value_ratio", std::pow(10.0, -6)}});
    };
    EXPECT_LT(error("ours", "error_max"), 5e-10);
    EXPECT_LT(error("ours", "null_space_error_max"), 5e-10);
    EXPECT_GT(error("normal equations", "error_max"), 1e-7);
    EXPECT_GT(error("ours, damped", "error_max"), 0.5) << "it is damped on purpose";
  }
}

}  // namespace
}  // namespace tactus
