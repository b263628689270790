#include "campaign/judges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/plant/slave_axis.h"

namespace tactus::campaign {
namespace {

using enum Mode;

constexpr int kRampMargin_cycles = 5;
constexpr int kRetreat_ms = 1502;
constexpr int kBrakeDeadline_ms = 500;
constexpr int kRest_ms = 1000;
constexpr double kRestVelocity = 1e-3;
constexpr double kLongStop_s = 1e3;
constexpr int kTorque_ms = 100;
constexpr int kSettle_ms = 300;    ///< for drives to have stopped after a hold
constexpr double kStopWay = 0.05;  ///< of a drive that stops by itself, m or rad
constexpr double kMaxForceError_N = 1.5;
constexpr int kForceJudged_ms = 2000;
constexpr int kEnd_ms = 8000;

/// "j4 0.123": the joint with the largest of these.
std::string largest(const JointVector& v) {
  Eigen::Index joint = 0;
  const double size = v.cwiseAbs().maxCoeff(&joint);
  return fmt::format("j{} {:.4g}", joint + 1, size);
}

double rampCycles(const Look& look) {
  const JointVector change = look.promise.limits.max_acceleration * look.promise.period_s;
  return std::ceil(look.before.command.cwiseAbs().cwiseQuotient(change).maxCoeff());
}

}  // namespace

void Look::complain(const char* judge, const std::string& what, const std::string& detail) const {
  const bool is_known = std::any_of(found.begin(), found.end(),
                                    [&](const Violation& old) { return old.what == what; });
  if (!is_known) found.push_back({judge, what, detail, now.t_ms});
}

void LimitsJudge::look(const Look& look) {
  const Observation& now = look.now;
  const JointLimits& limits = look.promise.limits;
  if (!now.command.allFinite()) look.complain("limits", "command not finite");
  if ((now.command.cwiseAbs() - limits.max_velocity).maxCoeff() > 1e-9)
    look.complain("limits", "command beyond the velocity limit", largest(now.command));
  const JointVector count = look.promise.counts_per_unit.cwiseInverse();
  const JointVector beyond = now.setpoint.cwiseAbs() - limits.max_velocity - count;
  if (!(beyond.array() <= 0.0).all())  // no NaN is within
    look.complain("limits", "setpoint beyond the velocity limit", largest(now.setpoint));
  if (!isCommanding(now.mode)) return;
  const JointVector before =
      isCommanding(look.before.mode) ? look.before.command : JointVector::Zero(now.command.size());
  const JointVector change = (now.command - before).cwiseAbs();
  // A ramp to rest goes on in cycles that are missed.
  const bool is_ramp = now.mode == kHolding || now.mode == kStopping;
  const double time_s = is_ramp ? 1e-3 * (now.t_ms - look.before.t_ms) : look.promise.period_s;
  if ((change - limits.max_acceleration * time_s).maxCoeff() > 1e-9)
    look.complain("limits", "command beyond the acceleration limit", largest(change));
  for (int i = 0; i < now.setpoint.size(); ++i) {
    const bool is_command = std::abs(now.setpoint[i] - now.command[i]) <= 2.0 * count[i];
    if (now.setpoint[i] != 0.0 && !is_command)
      look.complain("limits", "setpoint is not the command", fmt::format("j{}", i + 1));
  }
}

void StopJudge::look(const Look& look) {
  const Observation& now = look.now;
  retreat_ms = now.mode == kRetreating && !look.entered(kRetreating)
                   ? retreat_ms + now.t_ms - look.before.t_ms
                   : 0;
  if (retreat_ms > kRetreat_ms) look.complain("stop", "a retreat without end");
  if (now.mode == kRunning || now.mode == kRetreating) return;
  const bool is_moving = !now.setpoint.isZero(0.0);
  const bool may_ramp = now.mode == kHolding || now.mode == kStopping;
  if (!may_ramp && is_moving)
    look.complain("stop", fmt::format("setpoint in {}", modeName(now.mode)), largest(now.setpoint));
  if (!may_ramp) return;
  if (now.mode != look.before.mode) {
    cycles = 0;
    allowed = static_cast<int>(rampCycles(look)) + kRampMargin_cycles;
  }
  if (++cycles > allowed && is_moving)
    look.complain("stop", fmt::format("setpoint after the ramp of {}", modeName(now.mode)),
                  fmt::format("{} in cycle {} of {}", largest(now.setpoint), cycles, allowed));
}

void EnableJudge::look(const Look& look) {
  const Observation& now = look.now;
  off_ms = now.enable ? 0 : off_ms + now.t_ms - look.before.t_ms;
  if (!now.enable) last_off_ms = now.t_ms;
  const int ramp_ms = static_cast<int>(
      1e3 * look.promise.limits.max_velocity.cwiseQuotient(look.promise.limits.max_acceleration)
                .maxCoeff());
  if (off_ms > ramp_ms + kRampMargin_cycles && !now.setpoint.isZero(0.0))
    look.complain("enable", "setpoint while the enable line is off", largest(now.setpoint));
  if (now.mode == kRunning && !now.enable) look.complain("enable", "running while not enabled");
  if (look.entered(kRunning) || look.entered(kEnabling)) {
    if (last_off_ms < last_stop_ms)
      look.complain("enable", fmt::format("{} without off and on", modeName(now.mode)));
    if (last_cause_ms >= 0 && last_off_ms <= last_cause_ms)
      look.complain("enable",
                    fmt::format("{} without off and on after the cause", modeName(now.mode)));
  }
  const bool is_stop = look.entered(kFault) || look.entered(kRetreating) ||
                       look.entered(kHolding) || look.entered(kStopping);
  const bool is_new_fault = now.fault != Fault::kNone && now.fault != look.before.fault;
  if (is_stop || is_new_fault) last_stop_ms = now.t_ms;
  if (now.has_cause) last_cause_ms = now.t_ms;
}

void BrakeJudge::look(const Look& look) {
  const Observation& now = look.now;
  const int step_ms = now.t_ms - look.before.t_ms;
  fault_ms = now.mode == kFault && !look.entered(kFault) ? fault_ms + step_ms : 0;
  limp_ms = now.is_brake_open && !now.has_torque ? limp_ms + 1 : 0;  // missed cycles do nothing
  if (!now.is_brake_open) return;
  if (limp_ms > kBrakeDeadline_ms + look.promise.brake_ms)
    look.complain("brake", "open while no drive has torque");
  if (now.mode == kOff) look.complain("brake", "open at the end");
  if (now.mode == kBoot || now.mode == kReady) look.complain("brake", "open before enabling");
  if (now.is_emergency) look.complain("brake", "open in an emergency");
  if (now.mode == kFault && !look.before.is_brake_open)
    look.complain("brake", "opens in fault", faultName(now.fault));
  if (fault_ms > kBrakeDeadline_ms + look.promise.brake_ms)
    look.complain("brake", "open in fault after the deadline", faultName(now.fault));
}

void RestJudge::look(const Look& look) {
  const Observation& now = look.now;
  const int step_ms = now.t_ms - look.before.t_ms;
  const bool may_move = isCommanding(now.mode) || now.mode == kEnabling;
  rest_ms = may_move ? 0 : rest_ms + step_ms;
  off_ms = now.mode == kOff ? off_ms + step_ms : 0;
  const JointVector speed = now.velocity.cwiseAbs();
  const bool is_stopping = now.mode != kRunning && look.before.mode == kRunning;
  const bool is_anew =
      now.mode == kRunning || look.entered(kEnabling) || is_stopping || peak.size() == 0;
  peak = is_anew ? speed : peak.cwiseMax(speed);
  has_let_go =
      now.powers_taken > look.before.powers_taken || (has_let_go && !look.entered(kEnabling));
  const double coasting = has_let_go ? SlaveAxis::kCoastingDeceleration : kNoLimit;
  const JointVector stop_s = peak.cwiseQuotient(look.promise.quick_stop.cwiseMin(coasting));
  const int stop_ms = static_cast<int>(1e3 * std::min(stop_s.maxCoeff(), kLongStop_s));
  const bool is_moving = speed.maxCoeff() > kRestVelocity;
  const int since_ms = now.mode == kOff ? off_ms : rest_ms;
  if (since_ms > kRest_ms + stop_ms && is_moving)
    look.complain("rest", fmt::format("a drive moves in {}", modeName(now.mode)),
                  largest(now.velocity));
  torque_ms = now.mode == kReady && now.has_torque ? torque_ms + step_ms : 0;
  if (torque_ms > kTorque_ms) look.complain("rest", "a drive has torque in ready");
  if (off_ms > kRest_ms && now.has_torque)
    look.complain("rest", "a drive has torque after the end");
  if (is_anew || now.mode == kRetreating) stopped_ms = 0;
  stopped_ms += step_ms;
  if (now.mode == kRunning || now.mode == kRetreating) return;
  if (stopped_ms <= kSettle_ms || position.size() == 0) position = now.position;
  const JointVector way = now.position - position;
  const double braking = 0.5 * peak.cwiseProduct(stop_s).maxCoeff();
  if (way.cwiseAbs().maxCoeff() > look.promise.max_following_error + kStopWay + braking)
    look.complain("rest", "a joint goes far after a stop", largest(way));
}

void PlaceJudge::look(const Look& look) {
  const bool starts = look.entered(kRunning) || look.entered(kEnabling);
  constexpr int kSeen_ms = 10;
  if (starts && look.now.pushed_ms > kSeen_ms)
    look.complain("place", fmt::format("{} after a push", modeName(look.now.mode)),
                  fmt::format("{:.3f}", look.now.pushed));
}

void CauseJudge::look(const Look& look) {
  if (look.now.mode != kRunning) return;
  if (look.now.has_cause) look.complain("cause", "running with a cause that it is told");
  if (look.now.hidden_cause)
    look.complain("cause", fmt::format("running with {}", look.now.hidden_cause));
}

void NameJudge::look(const Look& look) {
  const Observation& now = look.now;
  const Observation& before = look.before;
  const std::string change = fmt::format("{} to {}", modeName(before.mode), modeName(now.mode));
  const bool has_changed = now.mode != before.mode;
  if (has_changed && !isLegal(before.mode, now.mode))
    look.complain("name", "not in the table of modes: " + change);
  const bool has_name = now.fault != Fault::kNone;
  const bool is_stop = (look.entered(kHolding) || look.entered(kStopping)) ||
                       (look.entered(kFault) || look.entered(kOff)) || look.entered(kRetreating);
  const bool may_be_unnamed = now.is_stop_requested || (!now.enable && now.mode != kFault);
  if (is_stop && !has_name && !may_be_unnamed) look.complain("name", "no reason: " + change);
  const bool is_cleared = (before.mode == kFault && now.mode == kBoot) ||
                          (before.mode == kHolding && now.mode == kRunning);
  if (before.fault != Fault::kNone && now.fault != before.fault && !is_cleared)
    look.complain("name",
                  fmt::format("fault {} became {}", faultName(before.fault), faultName(now.fault)),
                  change);
}

void EndJudge::look(const Look& look) {
  const bool is_waiting = look.now.is_stop_requested && look.now.mode != kOff;
  waiting_ms = is_waiting ? waiting_ms + look.now.t_ms - look.before.t_ms : 0;
  if (waiting_ms > kEnd_ms)
    look.complain("end", fmt::format("a stop request leaves it in {}", modeName(look.now.mode)));
}

void StaleJudge::look(const Look& look) {
  const bool is_new = look.now.stale_setpoints > look.before.stale_setpoints;
  if (is_new && !look.now.is_late_frame) look.complain("stale", "a drive followed an old setpoint");
}

void ForceJudge::look(const Look& look) {
  const bool is_judged = look.now.mode == kRunning && look.now.is_free;
  error_N =
      is_judged && ms > 0 ? std::min(error_N, look.now.force_error_N) : look.now.force_error_N;
  ms = is_judged ? ms + 1 : 0;
  if (ms > kForceJudged_ms && error_N > kMaxForceError_N)
    look.complain("force", "the sensor's zero is elsewhere", fmt::format("by {:.2f} N", error_N));
}

void PowerJudge::look(const Look& look) {
  held_ms = look.now.is_brake_open ? 0 : held_ms + look.now.t_ms - look.before.t_ms;
  const bool is_new = look.now.powers_taken > look.before.powers_taken;
  if (is_new && !look.now.may_let_go && held_ms < look.promise.brake_ms)
    look.complain("power", fmt::format("a drive lets go in motion in {}", modeName(look.now.mode)),
                  largest(look.now.velocity));
}

void Judges::look(const Look& look) {
  limits.look(look);
  stop.look(look);
  enable.look(look);
  brake.look(look);
  rest.look(look);
  place.look(look);
  cause.look(look);
  name.look(look);
  end.look(look);
  stale.look(look);
  force.look(look);
  power.look(look);
}

}  // namespace tactus::campaign
