#include "tactus/control/controller.h"

/// What a controller takes from the tactile modules.
namespace tactus {

void Controller::watchSensors(const RobotInput& input, double period_s,
                              ControllerState& state) const noexcept {
  for (int i = 0; i < modules(); ++i) read(i, input, period_s, state.modules[i]);
}

Fault Controller::read(int module, const RobotInput& input, double period_s,
                       TactileReading& reading) const noexcept {
  const TactileModuleConfig& config = config_.tactile_modules[module];
  const TactileSample& sample = input.tactile[module];
  if (covers_.empty()) return readSample(config, sample, period_s, reading);
  return readSample(config,
                    covers_[module].relieve(sample, input.q_measured, period_s, reading.cover),
                    period_s, reading);
}

FaultDetail Controller::sampleAge(int module, const RobotInput& input, double period_s,
                                  const ControllerState& state) const noexcept {
  const double age_s = sampleAge_s(input.tactile[module], period_s, state.modules[module]);
  return {age_s, config_.tactile_modules[module].max_sample_age_s, "s", -1, module};
}

/// Of several modules with a fault the first one counts.
void Controller::sense(const RobotInput& input, double period_s, ControllerState& state,
                       ControllerOutput& output) const noexcept {
  output.modules = modules();
  for (int i = 0; i < output.modules; ++i) {
    TactileReading& reading = state.modules[i];
    const Fault fault = read(i, input, period_s, reading);
    if (state.fault == Fault::kNone && fault != Fault::kNone) {
      state.fault = fault;
      if (!state.is_stopping) state.retreat.velocity_at_fault = state.velocity_before;
      output.fault_detail = reading.detail;
      output.fault_detail.module = i;
    }
    output.sensed[i] = reading.contact;
  }
}

}  // namespace tactus
