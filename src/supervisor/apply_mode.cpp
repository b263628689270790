#include "tactus/supervisor/apply_mode.h"

namespace tactus {

bool resetsController(Mode mode, Mode before) noexcept {
  return !isCommanding(mode) && isCommanding(before);
}

void forgetMotionWhileBooting(Mode mode, Mode before, ControllerState& state) noexcept {
  if (mode != Mode::kBoot && before != Mode::kBoot) return;
  for (TactileReading& reading : state.modules) reading.cover.has_started = false;
}

void applyMode(const Controller& controller, Mode mode, Mode before, const RobotInput& input,
               const Gains& gains, ControllerState& state) noexcept {
  forgetMotionWhileBooting(mode, before, state);
  if (resetsController(mode, before)) controller.restart(gains, state);
  // Where drives stop by themselves, the arm is where they say.
  if (!isCommanding(mode) || !isCommanding(before))
    controller.place(input.q_measured, gains, state);
  if (isCommanding(mode) && !isCommanding(before)) controller.begin(state);
  const auto isStill = [](Mode m) { return m == Mode::kRetreating || m == Mode::kHolding; };
  if (isStill(mode) && before == Mode::kRunning) controller.hold(gains, state);
  if (mode == Mode::kRetreating && before != Mode::kRetreating)
    controller.beginRetreat(gains, state);
  state.retreat.is_under_way = mode == Mode::kRetreating;
  if (mode == Mode::kRunning && isStill(before)) controller.goOn(gains, state);
  // While it retreats or holds, faults come and go: the mode remembers them.
  if (isStill(mode) || isStill(before)) state.fault = Fault::kNone;
  state.is_stopping = mode != Mode::kRunning;
}

}  // namespace tactus
