#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tactus/bench/bench_robot.h"

namespace tactus {

/// A whole control step of some code, ready to be run from kStepStates states along a motion.
struct StepCase {
  std::string code;
  int joints = 0, task_components = 0, contacts = 0;
  std::function<void()> prepare;         ///< sets all states back to where they were
  std::function<void(int)> step;         ///< one step from state i
  std::function<JointVector()> command;  ///< of the last step, m/s or rad/s
};

inline constexpr int kStepStates = 64;
inline constexpr const char* kCodeOurs = "ours";
inline constexpr const char* kCodePrepared = "ours, sensor to command";
inline constexpr const char* kCodeSvd = "Eigen SVD";
inline constexpr const char* kCodeKdl = "KDL wdls";
inline constexpr const char* kCodeWdlsOnce = "KDL wdls, one solve";
inline constexpr const char* kCodeNsoOnce = "KDL pinv_nso, one solve";

/// Every code for this robot. The same commands come from ours, whole and with what needs no sensor
/// prepared, from plain Eigen with an SVD, and from KDL's wdls; without contact also what KDL's
/// solvers alone take.
std::vector<StepCase> stepCases(int joints, int task_components, int contacts);

/// The tool's error and one solve, without joint limits: less than a step. J# w by wdls and, for
/// six components, pinv_nso, which adds a pull towards the middle of the joints' ranges.
std::vector<StepCase> kdlSolverCases(int joints, int task_components);

}  // namespace tactus
