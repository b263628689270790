#include "tactus/run/virtual_cycle.h"

#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

/// As the daemon's after the next cycle; but a command that is no number the controller answers
/// itself.
Mode modeAfter(Mode before, Fault fault, const RetreatState& retreat) {
  if (faultRow(fault).reaction != Reaction::kRetreat) return Mode::kRunning;
  const bool is_left = before == Mode::kRetreating && retreat.is_over;
  return is_left || before == Mode::kHolding ? Mode::kHolding : Mode::kRetreating;
}

}  // namespace

VirtualCycle::VirtualCycle(const Scene& scene, const JointVector& q)
    : controller_(scene.controller),
      period_s_(scene.period_s),
      state_(controller_.initialState(q)) {
  controller_.begin(state_);
}

void VirtualCycle::note(Fault fault, int module) noexcept {
  if (end_.fault != Fault::kNone) return;
  end_.fault = fault;
  end_.time_s = time_s();
  end_.detail.module = module;
}

void VirtualCycle::update(const RobotInput& input) noexcept {
  const Gains& gains = config().gains;
  t_s_ = time_s();
  task_time_s_ = static_cast<double>(task_cycle_) * period_s_;
  const Mode mode_before = mode_;
  mode_ = modeAfter(mode_before, end_.fault, state_.retreat);
  applyMode(controller_, mode_, mode_before, input, gains, state_);
  controller_.update(input, gains, task_time_s_, period_s_, state_, output_);
  if (output_.fault != Fault::kNone && end_.fault == Fault::kNone) {
    end_.fault = output_.fault;
    end_.time_s = t_s_;
    end_.joint = output_.fault_detail.joint;
    end_.detail = output_.fault_detail;
  }
  ++cycle_;
  task_cycle_ += mode_ == Mode::kRunning ? 1 : 0;
}

bool VirtualCycle::isAtRest() const noexcept {
  return end_.fault != Fault::kNone && mode_ != Mode::kRetreating && output_.velocity.isZero(0.0);
}

void VirtualCycle::fill(const RobotInput& input, const Vector3& tool_error_m,
                        CycleRecord& record) const noexcept {
  fillRecord(t_s_, input, config().gains, output_, tool_error_m, record);
  record.task_time_s = task_time_s_;
  if (state_.tool_motion) record.tool_motion = state_.tool_motion->plan();
  record.mode = static_cast<std::uint64_t>(mode_);
  if (end_.fault != Fault::kNone) record.fault = static_cast<std::uint64_t>(end_.fault);
}

}  // namespace tactus
