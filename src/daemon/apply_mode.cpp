#include "tactus/daemon/apply_mode.h"

namespace tactus {

bool isCommanding(Mode mode) noexcept {
  return mode == Mode::kRunning || mode == Mode::kHolding || mode == Mode::kStopping;
}

bool resetsController(Mode mode, Mode before) noexcept {
  return !isCommanding(mode) || !isCommanding(before);
}

void applyMode(const Controller& controller, Mode mode, Mode before, const RobotInput& input,
               ControllerState& state) noexcept {
  // Where drives stop by themselves, the arm is where they say.
  if (resetsController(mode, before)) state = controller.initialState(input.q_measured);
  // While holding, faults come and go: the mode remembers them.
  if (mode == Mode::kHolding || before == Mode::kHolding) state.fault = Fault::kNone;
  state.is_stopping = mode != Mode::kRunning;
}

}  // namespace tactus
