#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tactus/bench/motion_problem.h"

namespace tactus {

/// A way to solve a motion problem: from J to J# w and N v.
template <typename Scalar>
struct PseudoinverseMethod {
  std::string name;
  bool is_damped;  ///< its error near singularities is intended
  void (*solve)(const MotionProblem<Scalar>& problem, MotionParts<Scalar>& parts);
};

/// lambda of the damped variants, the largest of ours.
inline constexpr double kBenchDamping = 0.05;

template <typename Scalar>
std::vector<PseudoinverseMethod<Scalar>> textbookMethods();
extern template std::vector<PseudoinverseMethod<double>> textbookMethods<double>();
extern template std::vector<PseudoinverseMethod<float>> textbookMethods<float>();

/// WeightedPseudoinverse, exact and as it is damped in an arm. Only in double.
std::vector<PseudoinverseMethod<double>> ourMethods();

}  // namespace tactus
