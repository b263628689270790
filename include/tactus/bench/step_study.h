#pragma once

#include <map>
#include <string>
#include <vector>

#include "tactus/bench/step_case.h"
#include "tactus/bench/table.h"

namespace tactus {

struct StepSizes {
  std::vector<int> joints = {6, 7, 9, 12, 16};
  int batches = 31;      ///< of kStepStates steps each, timed in warm caches
  int cold_steps = 128;  ///< timed in cold caches
};

/// Every code with every size that it can do: 3 task components; 6 where joints are left.
std::vector<StepCase> allStepCases(const std::vector<int>& joints);

/// A row a case; `instructions` by countLabel(), not measured where one is missing.
Table measureSteps(const StepSizes& sizes, const std::map<std::string, double>& instructions);

/// The largest deviation of y from the straight line through x, least squares, relative to y.
double deviationFromLine(const std::vector<std::array<double, 2>>& points);

}  // namespace tactus
