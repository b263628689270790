#include "tactus/supervisor/mode.h"

#include <algorithm>
#include <array>

#include "tactus/supervisor/mode_table.h"

namespace tactus {
namespace {

void note(ModeState& state, Fault fault) noexcept {
  if (fault == Fault::kNone) return;
  if (state.fault == Fault::kNone) state.fault = fault;
  state.reaction = std::max(state.reaction, faultRow(fault).reaction);
  state.may_clear = false;
}

int timeLimit_cycles(const ModeConfig& config, Mode mode) noexcept {
  switch (mode) {
    case Mode::kBoot:
      return config.boot_cycles;
    case Mode::kEnabling:
      return config.enabling_cycles;
    case Mode::kRetreating:
      return config.retreating_cycles;
    case Mode::kStopping:
    case Mode::kFault:
      return config.stopping_cycles;
    default:
      return kMaxCyclesInMode;
  }
}

/// All that hold.
std::uint32_t conditions(const ModeConfig& config, const ModeInput& input,
                         const ModeState& state) noexcept {
  const bool is_time_over = state.cycles_in_mode > timeLimit_cycles(config, state.mode);
  const auto either = [](bool is, std::uint32_t yes, std::uint32_t no) { return is ? yes : no; };
  const auto only = [](bool is, std::uint32_t yes) { return is ? yes : 0; };
  return either(input.enable, kIfEnableOn, kIfEnableOff) |
         either(input.has_enable_line, kIfEnableLine, kIfNoEnableLine) |
         either(input.are_enabled, kIfFollowing, kIfNotFollowing) |
         only(input.stop_requested, kIfStopRequested) | only(input.are_configured, kIfConfigured) |
         only(state.enabled_cycles >= config.brake_cycles, kIfBrakesHadTime) |
         only(input.is_at_rest, kIfAtRest) | only(input.are_disabled, kIfDrivesOff) |
         only(input.are_disabled || is_time_over, kIfOffOrTimeOver) |
         only(is_time_over, kIfTimeOver) | only(input.is_retreat_over, kIfRetreatOver) |
         only(state.fault != Fault::kNone, kIfFault) |
         only(state.reaction == Reaction::kRetreat, kIfRetreats) |
         only(state.reaction == Reaction::kRamp, kIfRamps) |
         only(state.reaction >= Reaction::kQuickStop, kIfStopsAtOnce) |
         only(input.fault == Fault::kNone, kIfCauseGone) | only(state.may_clear, kIfWasOff);
}

void take(const ModeRow& row, ModeState& state) noexcept {
  note(state, row.time_limit);
  if (row.effect == ModeEffect::kCountFollowing) ++state.enabled_cycles;
  if (row.effect == ModeEffect::kCountAnew) state.enabled_cycles = 0;
  if (row.effect == ModeEffect::kRememberOff) state.may_clear = true;
  if (row.effect == ModeEffect::kClear) {
    state.fault = Fault::kNone;
    state.reaction = Reaction::kNone;
    state.may_clear = false;
  }
  if (row.to == state.mode) return;
  state.mode = row.to;
  state.cycles_in_mode = 0;
  state.enabled_cycles = 0;
}

}  // namespace

const char* modeName(Mode mode) noexcept {
  static constexpr std::array<const char*, kModeCount> kNames = {
      "boot", "ready", "enabling", "running", "holding", "stopping", "fault", "off", "retreating"};
  return kNames[static_cast<std::size_t>(mode)];
}

bool isCommanding(Mode mode) noexcept {
  return mode == Mode::kRunning || mode == Mode::kRetreating || mode == Mode::kHolding ||
         mode == Mode::kStopping;
}

void updateMode(const ModeConfig& config, const ModeInput& input, ModeState& state) noexcept {
  note(state, input.fault);
  // Stops have deadlines of time; all else waits for what is heard in cycles that are there.
  const bool is_stop = state.mode == Mode::kRetreating || state.mode == Mode::kStopping ||
                       state.mode == Mode::kFault;
  const long long cycles = 1LL + (is_stop ? input.missed_cycles : 0) + state.cycles_in_mode;
  state.cycles_in_mode = static_cast<int>(std::min<long long>(cycles, kMaxCyclesInMode));
  const std::uint32_t held = conditions(config, input, state);
  for (const ModeRow& row : modeRows())
    if (row.from == state.mode && (row.conditions & held) == row.conditions)
      return take(row, state);
}

WayOn wayOn(const ModeConfig& config, const ModeInput& input, const ModeState& state) noexcept {
  if (!input.has_enable_line || input.stop_requested) return {};
  const WayOn until_on{input.enable        ? WaitsFor::kNothing
                       : input.must_go_off ? WaitsFor::kEnableOff
                                           : WaitsFor::kEnableOn};
  if (state.mode == Mode::kReady) return until_on;
  const bool is_off_next =
      state.mode == Mode::kFault || (state.mode == Mode::kStopping && state.fault != Fault::kNone);
  if (!is_off_next && state.mode != Mode::kHolding) return {};
  if (input.fault != Fault::kNone) return {WaitsFor::kFaultGone, input.fault};
  const bool is_heard =
      state.mode == Mode::kHolding ||
      (state.mode == Mode::kFault && (conditions(config, input, state) & kIfOffOrTimeOver) != 0);
  if (!is_heard) return {WaitsFor::kDrivesOff};
  return state.may_clear ? until_on : WayOn{WaitsFor::kEnableOff};
}

}  // namespace tactus
