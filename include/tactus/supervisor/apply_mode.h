#pragma once

#include "tactus/control/controller.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// Whether the controller forgets what it has commanded, all but the sensor's newest sample.
bool resetsController(Mode mode, Mode before) noexcept;

/// Drives that are being configured may say anything of where joints are, which is no motion of the
/// covers on them: what modules feel of that begins anew once all drives are.
void forgetMotionWhileBooting(Mode mode, Mode before, ControllerState& state) noexcept;

/// How the mode of a cycle and of the one before act on the controller. A function of what the log
/// holds, so that a replay does the same.
void applyMode(const Controller& controller, Mode mode, Mode before, const RobotInput& input,
               const Gains& gains, ControllerState& state) noexcept;

}  // namespace tactus
