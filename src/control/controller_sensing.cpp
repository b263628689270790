#include <algorithm>
#include <cmath>
#include <span>

#include "tactus/control/controller.h"
#include "tactus/control/module_loss.h"

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

bool Controller::goesOnWithout(int module, const Gains& gains,
                               const ControllerState& state) const noexcept {
  const TactileReading& reading = state.modules[module];
  const bool may_lose = reading.is_lost || (state.fault == Fault::kNone && !state.is_stopping);
  // A law may have brought a contact down to its threshold; below this it is over.
  const double released_N =
      std::min(gains.force.transition.release_force_N, gains.force.contact_threshold_N);
  if (!config_.module_loss || !may_lose || !mayBeLost(reading, released_N)) return false;
  for (int i = 0; i < modules(); ++i)
    if (i != module && isGood(state.modules[i], config_.tactile_modules[i])) return true;
  return false;
}

/// The arm goes on without modules that have a fault now, as long as another is good.
void Controller::goOnWithoutLost(const Gains& gains, double period_s, ModuleFaults& faults,
                                 ControllerState& state, ControllerOutput& output) const noexcept {
  for (int i = 0; i < modules(); ++i)
    if (faults[i] == Fault::kNone) prove(period_s, state.modules[i]);
  output.modules_lost = 0;
  for (int i = 0; i < modules(); ++i) {
    if (faults[i] == Fault::kNone || !goesOnWithout(i, gains, state)) continue;
    lose(state.modules[i]);
    faults[i] = Fault::kNone;
    output.modules_lost |= std::uint64_t{1} << i;
    output.sensed[i] = state.modules[i].contact;
  }
  output.speed_share = state.speed_share;
  state.speed_share = speedShareAfter(period_s, state);
}

double Controller::speedShareAfter(double duration_s, const ControllerState& state) const noexcept {
  return nextSpeedShare(config_.module_loss->speed_share,
                        std::span(state.modules).first(static_cast<std::size_t>(modules())),
                        duration_s, state.speed_share);
}

/// All of the motion without contact, which is linear in these.
void Controller::slowDown(double speed_share, PreparedCycle& prepared) noexcept {
  prepared.progress *= speed_share;
  prepared.w_d_dot *= speed_share;
  prepared.kinematics.y_eff *= speed_share;
  prepared.motion.y *= speed_share;
  prepared.motion.v_scaled *= speed_share;
}

/// The whole command, so that the arm keeps its direction.
void Controller::boundSpeeds(double speed_share, JointVector& velocity) const noexcept {
  double largest = 0.0;
  for (int i = 0; i < velocity.size(); ++i)
    largest = std::max(largest, std::abs(velocity[i]) / config_.limits.max_velocity[i]);
  if (largest > speed_share) velocity *= speed_share / largest;
}

void Controller::sense(const RobotInput& input, const Gains& gains, double period_s,
                       PreparedCycle& prepared, ControllerState& state,
                       ControllerOutput& output) const noexcept {
  output.modules = modules();
  ModuleFaults faults;
  bool is_told_more = config_.module_loss.has_value();
  for (int i = 0; i < output.modules; ++i) {
    faults[i] = read(i, input, period_s, state.modules[i]);
    is_told_more |= faults[i] != Fault::kNone;
    output.sensed[i] = state.modules[i].contact;
  }
  if (is_told_more) judgeModules(gains, period_s, faults, prepared, state, output);
}

/// Of several modules with a fault the first one counts that was not lost already, which is what is
/// new; -1: none has one.
int Controller::newlyFaulty(const ModuleFaults& faults,
                            const ControllerState& state) const noexcept {
  int first = -1;
  for (int i = 0; i < modules(); ++i) {
    if (faults[i] == Fault::kNone) continue;
    if (!state.modules[i].is_lost) return i;
    if (first < 0) first = i;
  }
  return first;
}

void Controller::judgeModules(const Gains& gains, double period_s, ModuleFaults& faults,
                              PreparedCycle& prepared, ControllerState& state,
                              ControllerOutput& output) const noexcept {
  if (config_.module_loss) {
    slowDown(state.speed_share, prepared);
    goOnWithoutLost(gains, period_s, faults, state, output);
  }
  const int culprit = newlyFaulty(faults, state);
  if (state.fault != Fault::kNone || culprit < 0) return;
  state.fault = faults[culprit];
  if (!state.is_stopping) state.retreat.velocity_at_fault = state.velocity_before;
  output.fault_detail = state.modules[culprit].detail;
  output.fault_detail.module = culprit;
}

}  // namespace tactus
