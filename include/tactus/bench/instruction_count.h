#pragma once

#include <map>
#include <string>
#include <vector>

#include "tactus/bench/step_case.h"

namespace tactus {

/// The name of a case among counts.
std::string countLabel(const StepCase& step_case);

/// Runs some steps of each case so that callgrind counts them alone, case by case. Without
/// valgrind around it nothing is counted.
void runUnderCallgrind(const std::vector<StepCase>& cases);

/// Steps of a case that runUnderCallgrind() runs.
inline constexpr int kCountedSteps = 16;

/// Runs `command` under callgrind (its first word is a path) and returns the instructions a step by
/// label; empty where there is no valgrind, or it fails.
std::map<std::string, double> countInstructions(const std::vector<std::string>& command);

}  // namespace tactus
