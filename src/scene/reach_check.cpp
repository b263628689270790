#include "tactus/scene/reach_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/analysis/path_contacts.h"
#include "tactus/control/controller.h"
#include "tactus/control/path_progress.h"
#include "tactus/math/rotation.h"

namespace tactus {
namespace {

constexpr double kMaxSteps = 2000.0;  ///< some milliseconds
constexpr double kSettling_s = 1.0;
constexpr int kMostTimes = 5;  ///< as long as the way: joints may be slower than the reference

/// What a task asks for and the tool does not have, m and rad.
struct Missing {
  double position_m = 0.0, rotation_rad = 0.0;
};

Missing missingTo(const TaskConfig& task, const Pose& target, const Pose& is) {
  const Vector3 line = target.p_AB - is.p_AB;
  const Vector3 turn = rotationVector(target.R_AB * is.R_AB.transpose());
  Missing missing;
  for (int i = 0; i < task.size; ++i) {
    const int component = task.components[i];
    double& sum = component < 3 ? missing.position_m : missing.rotation_rad;
    sum = std::hypot(sum, component < 3 ? line[component] : turn[component - 3]);
  }
  return missing;
}

bool hasArrived(const TaskCommandsConfig& commands, const Missing& missing) {
  return missing.position_m <= commands.arrival_m && missing.rotation_rad <= commands.arrival_rad;
}

/// Since a while ago, by a hundredth at least of what was missing then.
bool isNearer(const Missing& missing, const Missing& before) {
  constexpr double kShare = 0.99;
  return missing.position_m < kShare * before.position_m ||
         missing.rotation_rad < kShare * before.rotation_rad;
}

/// What brings the tool back to its way, and joints out of their limits' zones, must not overshoot
/// in a step, which may be many cycles.
Gains slowedFor(double step_s, const ControllerConfig& config) {
  Gains gains = config.gains;
  double& beta_per_s = gains.task.drift_gain_per_s;
  beta_per_s = std::min(beta_per_s, 1.0 / step_s);
  gains.posture.gain_per_s = std::min(gains.posture.gain_per_s, 0.5 / step_s);
  if (!config.has_joint_limit_avoidance) return gains;
  const ScaledVector inv_sqrt_weights =
      scaled(config.weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones());
  const JointLimitZones zones =
      JointLimitAvoidance(config.limits, inv_sqrt_weights).zones(gains.joint_limit_avoidance);
  const double fastest_per_s = zones.slope.cwiseProduct(inv_sqrt_weights).maxCoeff();
  gains.joint_limit_avoidance.gain /= std::max(1.0, step_s * fastest_per_s);
  return gains;
}

bool isAtItsLimit(const ControllerConfig& config, const JointVector& q) {
  constexpr double kClose = 1e-6;
  return ((q - config.limits.lower).array() < kClose).any() ||
         ((config.limits.upper - q).array() < kClose).any();
}

}  // namespace

Reach followTo(const ControllerConfig& config, const JointVector& q, const Pose& X_BaseTool,
               const ToolMotionLimits& limits, double period_s) {
  ControllerConfig alone = undisturbed(config);
  // A reference that waits for a tool that is kept off something leads it no further round that.
  alone.gains.task.wait_beyond_m = config.gains.task.wait_beyond_m;
  alone.gains.task.wait_beyond_rad = config.gains.task.wait_beyond_rad;
  const Controller controller(alone);
  ControllerState state = controller.initialState(q);
  ControllerOutput output;
  const Pose X_BaseStart = tipPose(config.chain, q);
  Pose target = X_BaseTool;
  // What the task leaves free may have gone anywhere, and takes no time.
  if (!config.task.hasRotation()) target.R_AB = X_BaseStart.R_AB;
  for (int i = 0; i < 3; ++i)
    if (!config.task.controls(i)) target.p_AB[i] = X_BaseStart.p_AB[i];
  const double duration_s = state.tool_motion->to(0.0, target, limits).end_s();
  // Where the way leads does not depend on the speed.
  state.tool_motion = state.tool_motion->to(0.0, target, config.task.commands->limits);
  const double way_s = state.tool_motion->end_s();
  const double step_s = std::max(period_s, way_s / kMaxSteps);
  const auto steps = std::llround((way_s + kSettling_s) / step_s);
  const Gains gains = slowedFor(step_s, alone);
  const TaskConfig& task = config.task;
  Missing missing;
  for (int time = 0; time < kMostTimes; ++time) {
    for (long long i = time * steps; i < (time + 1) * steps; ++i)
      controller.update(RobotInput{}, gains, static_cast<double>(i) * step_s, step_s, state,
                        output);
    const Missing before = missing;
    missing = missingTo(task, target, tipPose(config.chain, state.q_desired));
    if (hasArrived(*task.commands, missing)) return {"", duration_s, state.q_desired};
    if (time > 0 && !isNearer(missing, before)) break;
  }
  return {fmt::format("out of reach: the way there ends {:.3g} mm and {:.3g} mrad off{}",
                      1e3 * missing.position_m, 1e3 * missing.rotation_rad,
                      isAtItsLimit(config, state.q_desired) ? ", with a joint at its limit" : ""),
          duration_s, state.q_desired};
}

}  // namespace tactus
