#include <algorithm>
#include <cmath>

#include "tactus/canopen/cycle_count.h"
#include "tactus/control/module_loss.h"
#include "tactus/supervisor/control_cycle.h"

/// What the cycle finds amiss in its own input, of whom that speaks, and by which value.
namespace tactus {
namespace {

/// A socket keeps no more frames than two cycles read; then one sample has to be new.
constexpr int kWithheldAfterPause = 3;

}  // namespace

void ControlCycle::noteCulprit(int missed_cycles) noexcept {
  report_ = {};
  report_.detail = judged_.detail;
  report_.missed_cycles = missed_cycles;
  report_.joint = judged_.joint;
  report_.bus = judged_.bus;
  if (judged_.joint < 0) return;
  report_.drive = robot_.drive(judged_.joint);
  report_.q_measured = input_.q_measured[judged_.joint];
  report_.q_expected = places_.commanded()[judged_.joint];
}

Fault ControlCycle::judge(const CycleInput& input) noexcept {
  judged_ = {};
  const auto found = [this](Fault fault) { return (judged_.fault = fault) != Fault::kNone; };
  if (input.lines.emergency_stop) return judged_.fault = Fault::kEmergencyStop;
  if (input.are_lines_lost) return judged_.fault = Fault::kGpioLost;
  if (found(judgeBuses(input)) || found(judgeDrives())) return judged_.fault;
  if (input.has_forbidden_call) return judged_.fault = Fault::kForbiddenSystemCall;
  if (mode_.mode != Mode::kBoot && input.late_in_a_row > max_late_cycles_) {
    judged_.detail = {static_cast<double>(input.late_in_a_row),
                      static_cast<double>(max_late_cycles_), "cycles"};
    return judged_.fault = Fault::kOverrun;
  }
  if (found(judgeTactile()) || found(judgeController())) return judged_.fault;
  return Fault::kNone;
}

/// Of the last cycle. At rest nothing starts on a reading that would stop it.
Fault ControlCycle::judgeController() noexcept {
  if (mode_.mode == Mode::kBoot) return Fault::kNone;
  if (isHeldByDrives()) {
    if (output_.fault == Fault::kNone) return Fault::kNone;
    judged_.detail = output_.fault_detail;
    judged_.joint = judged_.detail.joint;
    return output_.fault;
  }
  for (int module = 0; module < modules(); ++module) {
    const TactileReading& reading = state_.modules[module];
    if (reading.fault == Fault::kNone || reading.is_lost) continue;
    judged_.detail = reading.detail;
    judged_.detail.module = module;
    return reading.fault;
  }
  return Fault::kNone;
}

Fault ControlCycle::judgeBuses(const CycleInput& input) noexcept {
  const auto fault = std::find_if(input.bus_faults.begin(), input.bus_faults.end(),
                                  [](Fault candidate) { return candidate != Fault::kNone; });
  if (fault == input.bus_faults.end()) return Fault::kNone;
  judged_.bus = static_cast<int>(fault - input.bus_faults.begin());
  return *fault;
}

/// A drive's fault stays until its set-up begins anew, so it says nothing about the present once
/// it has been answered.
Fault ControlCycle::judgeDrives() noexcept {
  if (mode_.mode == Mode::kFault) return Fault::kNone;
  const DrivesReport drives = robot_.drives();
  judged_.joint = drives.joint;
  const bool is_about_to_move = mode_.mode == Mode::kReady || mode_.mode == Mode::kEnabling ||
                                (mode_.mode == Mode::kBoot && areConfigured());
  if (drives.fault != Fault::kNone) judged_.detail = robot_.drive(drives.joint).detail;
  if (drives.fault == Fault::kFollowingError) judged_.detail.unit = joint_units_[drives.joint];
  if (drives.fault != Fault::kNone) return drives.fault;
  if (isHeldByDrives() && !drives.are_enabled) {
    judged_.joint = firstNotFollowing();
    return Fault::kDriveStateLost;
  }
  if (!is_about_to_move) return Fault::kNone;
  const int joint = judged_.joint = places_.outOfPlace(input_.q_measured);
  if (joint < 0) return Fault::kNone;
  judged_.detail = {std::abs(input_.q_measured[joint] - places_.commanded()[joint]),
                    places_.tolerance(), joint_units_[joint]};
  return Fault::kNotAtStart;
}

bool ControlCycle::isHeldByDrives() const noexcept {
  return isCommanding(mode_.mode) && mode_.mode != Mode::kStopping;
}

/// Drives themselves forgive what is lost in the first cycles of operation, as on the way there.
int ControlCycle::firstNotFollowing() const noexcept {
  for (int joint = 0; joint < places_.commanded().size(); ++joint)
    if (robot_.drive(joint).state != DriveState::kOperationEnabled) return joint;
  return -1;
}

/// Of the mode that has ended: whom it waited for.
void ControlCycle::judgeTimeLimit(Mode mode) noexcept {
  judged_ = {};
  if (mode == Mode::kEnabling) judged_.joint = firstNotFollowing();
  if (mode == Mode::kStopping) judged_.joint = robot_.firstWithPower();
}

Fault ControlCycle::judgeTactile() noexcept {
  for (int module = 0; module < modules(); ++module) {
    const Fault fault = judgeModule(module);
    if (fault == Fault::kNone || isLeftOut(module, fault)) continue;
    judged_.detail.module = module;
    return fault;
  }
  return Fault::kNone;
}

/// A push beyond what channels can tell is no loss. One that is lost already stays left out when
/// the last good one fails, too: that one is what is new.
bool ControlCycle::isLeftOut(int module, Fault fault) const noexcept {
  const bool is_loss = fault == Fault::kTactileStale || fault == Fault::kTactileCableBreak;
  if (!is_loss || !isCommanding(mode_.mode)) return false;
  return state_.modules[module].is_lost || controller_.goesOnWithout(module, gains_, state_);
}

/// A cable that breaks now and then is broken, until it has been good for a while: the controller,
/// and a replay of it, know the module by its samples alone. After a pause longer than a sample may
/// be old, those that waited to be read are none of now: a full socket drops the newest.
void ControlCycle::withholdSamples(
    int missed_cycles,
    const std::array<TactileSample, kMaxTactileModules>& samples_before) noexcept {
  const bool may_move = isCommanding(mode_.mode) || mode_.mode == Mode::kEnabling;
  const double pause_s = missed_cycles * period_s_;
  for (int module = 0; module < modules(); ++module) {
    Withheld& withheld = withheld_[module];
    if (may_move && pause_s > controller_.config().tactile_modules[module].max_sample_age_s)
      withheld.cycles = std::max(withheld.cycles, kWithheldAfterPause);
    const Fault fault = robot_.tactileModules()[module].fault();
    if (fault == Fault::kTactileCableBreak && isLeftOut(module, fault))
      withheld.cycles = cyclesLasting(kModuleProof_s, period_s_);
    if (withheld.cycles == 0) continue;
    const bool is_new = input_.tactile[module].sequence != withheld.sequence;
    withheld.sequence = input_.tactile[module].sequence;
    if (withheld.cycles > 1 || is_new) --withheld.cycles;
    if (withheld.cycles > 0) input_.tactile[module] = samples_before[module];
  }
}

Fault ControlCycle::judgeModule(int module) noexcept {
  const TactileReceiver& receiver = robot_.tactileModules()[module];
  const bool is_boot = mode_.mode == Mode::kBoot;
  // Of a module that was silent before the controller gets no such sample, but it may be a push.
  const bool is_saturated = receiver.fault() == Fault::kTactileSaturated;
  if (!is_boot && (is_saturated || hasFreshSample(module))) return receiver.fault();
  if (is_boot && receiver.tareState() == TareState::kRefused) {
    judged_.detail = receiver.tareRefusal();
    return Fault::kTareRefused;
  }
  const bool is_late = mode_.cycles_in_mode >= mode_config_.boot_cycles;
  const bool is_missed = is_late && robot_.drives().are_configured && !isReady(module);
  if (is_boot && !is_missed) return Fault::kNone;
  judged_.detail = sampleAge(module);
  return Fault::kTactileStale;
}

FaultDetail ControlCycle::sampleAge(int module) const noexcept {
  FaultDetail age = controller_.sampleAge(module, input_, period_s_, state_);
  const SampleAtStart& first = samples_at_start_[module];
  if (is_started_ && input_.tactile[module].sequence == first.sequence) age.value += first.age_s;
  return age;
}

bool ControlCycle::hasFreshSample(int module) const noexcept {
  const FaultDetail age = sampleAge(module);
  return input_.tactile[module].sequence > 0 && age.value <= age.limit;
}

bool ControlCycle::isReady(int module) const noexcept {
  const TactileReceiver& receiver = robot_.tactileModules()[module];
  return receiver.tareState() == TareState::kDone && hasFreshSample(module);
}

}  // namespace tactus
