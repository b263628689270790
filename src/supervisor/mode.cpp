#include "tactus/supervisor/mode.h"

#include <algorithm>

namespace tactus {
namespace {

using enum Mode;

constexpr std::array<ModeTransition, kModeTransitionCount> kTransitions = {{
    {kBoot, kReady, "drives configured, modules tared"},
    {kBoot, kFault, "fault, or not configured in time"},
    {kBoot, kOff, "stop requested"},
    {kReady, kEnabling, "enable line on, or none"},
    {kReady, kFault, "fault"},
    {kReady, kOff, "stop requested"},
    {kEnabling, kRunning, "drives follow, brakes open"},
    {kEnabling, kStopping, "stop requested, enable line off, or a fault that ramps"},
    {kEnabling, kFault, "fault, or not switched on in time"},
    {kRunning, kRetreating, "a fault that retreats"},
    {kRunning, kHolding, "enable line off"},
    {kRunning, kStopping, "stop requested, or a fault that ramps"},
    {kRunning, kFault, "a fault that stops at once"},
    {kRetreating, kHolding, "out of the contact, enable line off, or time over"},
    {kRetreating, kStopping, "stop requested, or a fault that ramps"},
    {kRetreating, kFault, "a fault that stops at once"},
    {kHolding, kRunning, "enable line off and on, cause gone"},
    {kHolding, kStopping, "stop requested, a fault that ramps, or a fault and no enable line"},
    {kHolding, kFault, "a fault that stops at once"},
    {kStopping, kReady, "drives off, enable line had been switched off while enabling"},
    {kStopping, kFault, "drives off after a fault, a fault that stops at once, or time over"},
    {kStopping, kOff, "drives off"},
    {kFault, kBoot, "enable line off and on, cause gone"},
    {kFault, kOff, "drives off or time over, and a stop requested or no enable line"},
}};

void enter(ModeState& state, Mode mode) noexcept {
  if (!isLegal(state.mode, mode)) mode = kFault;  // cannot happen; the safe side if it does
  state.mode = mode;
  state.cycles_in_mode = 0;
  state.enabled_cycles = 0;
}

void note(ModeState& state, Fault fault) noexcept {
  if (fault == Fault::kNone) return;
  if (state.fault == Fault::kNone) state.fault = fault;
  state.reaction = std::max(state.reaction, faultRow(fault).reaction);
  state.may_clear = false;
}

void clear(ModeState& state) noexcept {
  state.fault = Fault::kNone;
  state.reaction = Reaction::kNone;
  state.may_clear = false;
}

/// Off and on again, after the cause has gone.
bool isCleared(const ModeInput& input, ModeState& state) noexcept {
  if (!input.has_enable_line || input.fault != Fault::kNone) return false;
  if (!input.enable) state.may_clear = true;
  return input.enable && state.may_clear;
}

void boot(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  if (input.stop_requested) return enter(state, kOff);
  if (state.cycles_in_mode > config.boot_cycles) note(state, Fault::kDriveSetupRefused);
  if (state.fault != Fault::kNone) return enter(state, kFault);
  if (input.are_configured) enter(state, kReady);
}

void ready(const ModeInput& input, ModeState& state) noexcept {
  if (input.stop_requested) return enter(state, kOff);
  if (state.fault != Fault::kNone) return enter(state, kFault);
  if (input.enable) enter(state, kEnabling);
}

void enabling(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  if (state.cycles_in_mode > config.enabling_cycles) note(state, Fault::kDriveStateLost);
  if (state.reaction >= Reaction::kQuickStop) return enter(state, kFault);
  if (input.stop_requested || !input.enable || state.fault != Fault::kNone)
    return enter(state, kStopping);
  state.enabled_cycles = input.are_enabled ? state.enabled_cycles + 1 : 0;
  if (state.enabled_cycles > config.brake_cycles) enter(state, kRunning);
}

void running(const ModeInput& input, ModeState& state) noexcept {
  if (state.reaction >= Reaction::kQuickStop) return enter(state, kFault);
  if (input.stop_requested || state.reaction == Reaction::kRamp) return enter(state, kStopping);
  if (!input.enable) return enter(state, kHolding);
  if (state.reaction == Reaction::kRetreat) enter(state, kRetreating);
}

void retreating(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  if (state.reaction >= Reaction::kQuickStop) return enter(state, kFault);
  if (input.stop_requested || state.reaction == Reaction::kRamp) return enter(state, kStopping);
  const bool is_over = input.is_retreat_over || state.cycles_in_mode > config.retreating_cycles;
  if (!input.enable || is_over) enter(state, kHolding);
}

void holding(const ModeInput& input, ModeState& state) noexcept {
  if (state.reaction >= Reaction::kQuickStop) return enter(state, kFault);
  const bool ends = state.fault != Fault::kNone && !input.has_enable_line && input.is_at_rest;
  if (input.stop_requested || state.reaction == Reaction::kRamp || ends)
    return enter(state, kStopping);
  if (!isCleared(input, state) || !input.is_at_rest) return;
  clear(state);
  enter(state, kRunning);
}

void stopping(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  if (state.cycles_in_mode > config.stopping_cycles) note(state, Fault::kDriveStateLost);
  if (state.reaction >= Reaction::kQuickStop) return enter(state, kFault);
  if (!input.is_at_rest || !input.are_disabled) return;
  if (state.fault != Fault::kNone) return enter(state, kFault);
  enter(state, input.stop_requested ? kOff : kReady);
}

void fault(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  const bool is_over = input.are_disabled || state.cycles_in_mode > config.stopping_cycles;
  if (!is_over) return;
  if (input.stop_requested || !input.has_enable_line) return enter(state, kOff);
  if (!isCleared(input, state)) return;
  clear(state);
  enter(state, kBoot);
}

}  // namespace

const char* modeName(Mode mode) noexcept {
  static constexpr std::array<const char*, kModeCount> kNames = {
      "boot", "ready", "enabling", "running", "holding", "stopping", "fault", "off", "retreating"};
  return kNames[static_cast<std::size_t>(mode)];
}

bool isCommanding(Mode mode) noexcept {
  return mode == kRunning || mode == kRetreating || mode == kHolding || mode == kStopping;
}

const std::array<ModeTransition, kModeTransitionCount>& modeTransitions() noexcept {
  return kTransitions;
}

bool isLegal(Mode from, Mode to) noexcept {
  return std::any_of(kTransitions.begin(), kTransitions.end(),
                     [&](const ModeTransition& row) { return row.from == from && row.to == to; });
}

void updateMode(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  note(state, input.fault);
  // Stops have deadlines of time; all else waits for what is heard in cycles that are there.
  const bool is_stop = state.mode == kRetreating || state.mode == kStopping || state.mode == kFault;
  const long long cycles = 1LL + (is_stop ? input.missed_cycles : 0) + state.cycles_in_mode;
  state.cycles_in_mode = static_cast<int>(std::min<long long>(cycles, kMaxCyclesInMode));
  switch (state.mode) {
    case kBoot:
      return boot(config, input, state);
    case kReady:
      return ready(input, state);
    case kEnabling:
      return enabling(config, input, state);
    case kRunning:
      return running(input, state);
    case kRetreating:
      return retreating(config, input, state);
    case kHolding:
      return holding(input, state);
    case kStopping:
      return stopping(config, input, state);
    case kFault:
      return fault(config, input, state);
    case kOff:
      return;
  }
}

}  // namespace tactus
