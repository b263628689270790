#include <algorithm>
#include <cmath>

#include "tactus/control/path_progress.h"
#include "tactus/supervisor/control_cycle.h"

/// Gains and tasks that are ordered while the arm moves.
namespace tactus {
namespace {

constexpr double kFullSpeed = 0.999;  ///< of a joint's largest speed

}  // namespace

void ControlCycle::goOnWithOrders() noexcept {
  goOnWithGains();
  if (tool_orders_) goOnWithTool();
}

/// Of the commanded configuration; an orientation that is not the task's stays the reference's.
Pose ControlCycle::toolPose() const noexcept {
  Pose X_BaseTool = tipPose(controller_.config().chain, state_.q_desired);
  if (!controller_.config().task.hasRotation())
    X_BaseTool.R_AB = state_.tool_motion->evaluate(nextPathTime_s()).R_BaseTool;
  return X_BaseTool;
}

/// An arm that goes on slowly without a module is not held off.
double ControlCycle::toolProgress() const noexcept { return state_.progress / output_.speed_share; }

double ControlCycle::nextPathTime_s() const noexcept {
  return static_cast<double>(nextTaskCycle()) * period_s_ - state_.waited_s;
}

void ControlCycle::fill(ToolSight& sight) const noexcept {
  sight.report = tool_orders_->report();
  sight.is_running = isRunning();
  // Before it has ever run the arm is not where its scene begins, but where it was put.
  const JointVector& q = is_started_ ? state_.q_desired : output_.q_desired;
  std::copy_n(q.data(), q.size(), sight.q);
  sight.run = runs_;
  Pose X_BaseTool = is_started_ ? toolPose() : tipPose(controller_.config().chain, q);
  if (is_started_ && toolProgress() >= kFreeProgress) {
    const ToolReference reference = state_.tool_motion->evaluate(nextPathTime_s());
    X_BaseTool = {reference.R_BaseTool, reference.p_BaseTool};
  }
  std::copy_n(X_BaseTool.p_AB.data(), 3, sight.p_BaseTool_m);
  std::copy_n(X_BaseTool.R_AB.data(), 9, sight.R_BaseTool);
  for (int i = 0; i < output_.modules; ++i) {
    sight.force_N[i] = output_.sensed[i].force_N;
    sight.position_m[i] = output_.sensed[i].position_m;
  }
}

void ControlCycle::goOnWithTool() noexcept {
  ToolWatch seen;
  seen.passed_s = (1 + missed_cycles_) * period_s_;
  seen.path_time_s = nextPathTime_s();
  seen.progress = toolProgress();
  const TaskConfig& task = controller_.config().task;
  const ToolLag lag = toolLag(task, paddedTask(output_.error));
  seen.lag_m = lag.position_m;
  seen.lag_rad = lag.rotation_rad;
  if (waitsForTurn(gains_.task, lag)) {
    for (int i = 0; i < task.size; ++i)
      if (task.components[i] >= 3)
        seen.turn_waited_for_rad[task.components[i] - 3] = output_.error[i];
  }
  seen.X_BaseTool = toolPose();
  seen.run = runs_;
  seen.is_running = isRunning();
  tool_orders_->update(seen, *state_.tool_motion);
}

/// By what the last cycle saw.
void ControlCycle::goOnWithGains() noexcept {
  GainWatchInput seen;
  for (int i = 0; i < output_.modules; ++i)
    seen.force_N = std::max(seen.force_N, output_.sensed[i].force_N);
  const JointVector& most = controller_.config().limits.max_velocity;
  for (int i = 0; i < output_.velocity.size(); ++i)
    seen.is_at_limit |= std::abs(output_.velocity[i]) >= kFullSpeed * most[i];
  seen.has_fault = mode_.fault != Fault::kNone;
  seen.is_running = isRunning();
  seen.is_held = mode_.mode == Mode::kHolding;
  const ControllerConfig& config = controller_.config();
  seen.can_feel = config.force_control && !config.tactile_modules.empty();
  gain_change_.update(seen);
  if (gain_change_.isChanging()) gains_ = gain_change_.gains();
}

/// Nothing that was ordered before moves a tool that goes on.
void ControlCycle::forgetOrders() noexcept {
  ++runs_;
  state_.tool_motion.emplace(toolPose(), state_.tool_motion->plan().number + 1);
}

}  // namespace tactus
