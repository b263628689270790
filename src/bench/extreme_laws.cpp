#include "tactus/bench/extreme_case.h"

namespace tactus {

const std::vector<ExtremeLaw>& extremeLaws() {
  static const std::vector<ExtremeLaw> laws = {
      {"assumed", {{"controller.variant", "null_task"}}},
      {"estimated", {{"controller.variant", "null_task"}, {"stiffness.estimate", "{}"}}},
      {"null_limit", {{"controller.variant", "null_limit"}, {"stiffness.estimate", "{}"}}},
      {"null_joint", {{"controller.variant", "null_joint"}}},
      {"null_space", {{"controller.variant", "null_space"}}},
      {"joint_space",
       {{"controller.variant", "joint_space"}, {"controller.transition.engage_force_N", "0.5"}}},
  };
  return laws;
}

}  // namespace tactus
