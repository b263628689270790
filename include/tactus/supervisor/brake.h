#pragma once

#include "tactus/supervisor/mode.h"

namespace tactus {

/// Times of stopping, in cycles.
struct BrakeConfig {
  int rest_cycles = 20;       ///< that drives hold at rest while brakes close
  int deadline_cycles = 500;  ///< in fault, after which brakes are closed whatever drives say
};

/// What a cycle knows of the drives when it decides on the brakes.
struct BrakeInput {
  bool are_enabled = false;       ///< every drive follows setpoints
  bool is_any_holding = false;    ///< one may yet hold its joint, or slow it down
  bool is_any_moving_on = false;  ///< one goes on as fast as before, though it was told to stop
  bool is_at_rest = true;         ///< the commanded velocity is zero
};

struct BrakeState {
  bool is_open = false;
  int rest_cycles = 0;  ///< in a row while stopping with zero velocity, as many as matter
};

/// One step, after updateMode(). Brakes close before the drives let go, and open before they move;
/// only after a quick stop do drives switch off by themselves. In a fault brakes close when no
/// drive holds any more, at once where a drive moves on, and at the deadline. Neither a fault nor a
/// stop opens one.
void updateBrake(const BrakeConfig& config, const ModeState& mode, const BrakeInput& input,
                 BrakeState& state) noexcept;

/// While stopping: the arm rests, and the brakes have had their time, so that drives may let go.
bool mayLetGo(const BrakeConfig& config, const BrakeState& state) noexcept;

}  // namespace tactus
