#include "tactus/daemon/apply_mode.h"

namespace tactus {
namespace {

/// The controller's command moves the arm, or keeps it where it is.
bool isCommanding(Mode mode) noexcept {
  return mode == Mode::kRunning || mode == Mode::kHolding || mode == Mode::kStopping;
}

}  // namespace

void applyMode(const Controller& controller, Mode mode, Mode before, const RobotInput& input,
               ControllerState& state) noexcept {
  // Where drives stop by themselves, the arm is where they say.
  if (!isCommanding(mode) || !isCommanding(before))
    state = controller.initialState(input.q_measured);
  // While holding, faults come and go: the mode remembers them.
  if (mode == Mode::kHolding || before == Mode::kHolding) state.fault = Fault::kNone;
  state.is_stopping = mode != Mode::kRunning;
}

}  // namespace tactus
