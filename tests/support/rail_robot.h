#pragma once

#include <algorithm>

#include "support/random_robot.h"
#include "support/tactile_samples.h"
#include "tactus/control/controller.h"

/// Two carriages on one rail along y: the module sits on the first, the tool on the second, the
/// task is the tool's y. All Jacobians are constant, so the paper's equations can be solved by
/// hand: k_j = 1, k_n = k_t = 1/2 for W = I, and a null-space motion is (1, -1).
namespace tactus::test {

inline SerialChain railChain() {
  std::vector<Joint> joints(2);
  for (Joint& joint : joints) {
    joint.type = JointType::kPrismatic;
    joint.axis = Vector3::UnitY();
  }
  return SerialChain(joints, {1, {}});
}

/// The paper's law without contact threshold; drift is not corrected.
inline ControllerConfig railController(Variant variant) {
  ControllerConfig config{.chain = railChain()};
  config.q_start = JointVector::Zero(2);
  config.limits = noLimits(2);
  config.task.components = {1};
  config.task.size = 1;
  config.gains.task.drift_gain_per_s = 0.0;
  config.weights = JointVector::Ones(2);
  config.tactile_modules.emplace_back();
  config.tactile_modules.front().link.joint = 0;
  config.tactile_modules.front().length_m = 1.0;
  config.force_control.emplace();
  config.force_control->variant = variant;
  config.gains.force.contact_threshold_N = 0.0;
  return config;
}

/// null_limit on its way along the rail, where nothing delays or filters, and c is known.
inline ControllerConfig undelayedRail(double speed_m_per_s, double stiffness_N_per_m) {
  ControllerConfig config = railController(Variant::kNullLimit);
  config.drive_lag_s = 0.0;
  config.tactile_modules.front().filter_cutoff_hz = 1e6;
  config.gains.force.assumed_stiffness_N_per_m = stiffness_N_per_m;
  Waypoint line;
  line.displacement_m = Vector3(0.0, 10.0, 0.0);
  line.speed_m_per_s = speed_m_per_s;
  line.ramp_s = 0.0;
  config.task.trajectory.waypoints = {line};
  return config;
}

/// An obstacle at +y that pushes the first carriage back like a linear spring; nothing delays or
/// filters what the module feels.
struct RailWorld {
  double stiffness_N_per_m = 1000.0;
  double surface_m = 0.0;

  double force_N(const JointVector& q) const {
    return std::max(0.0, stiffness_N_per_m * (q[0] - surface_m));
  }

  RobotInput input(const ControllerState& state) const {
    const std::uint32_t next = state.modules[0].sequence + 1;
    return {state.q_desired, {touchAt(0.5, -force_N(state.q_desired), 0.0, next)}};
  }
};

}  // namespace tactus::test
