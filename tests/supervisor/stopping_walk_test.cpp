#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <deque>
#include <map>
#include <set>
#include <vector>

#include "tactus/supervisor/brake.h"
#include "tactus/supervisor/mode.h"

/// Every state that modes and brakes can come to, over every input of every cycle, with time limits
/// of a few cycles: what holds there holds for ever.
namespace tactus {
namespace {

constexpr ModeConfig kModeConfig{.boot_cycles = 3,
                                 .enabling_cycles = 4,
                                 .retreating_cycles = 3,
                                 .stopping_cycles = 5,
                                 .brake_cycles = 1};
constexpr BrakeConfig kBrakeConfig{.rest_cycles = 1, .deadline_cycles = 2};
constexpr int kLongest = 7;  ///< cycles in a mode; more make no difference
/// While a hold or a stop ramps: set by the acceleration limits.
constexpr int kRampCycles = 2;

struct WalkState {
  ModeState mode;
  BrakeState brake;
  bool was_off = false;  ///< the enable line, since the last fault or hold: what may_clear means

  auto key() const {
    return std::array{static_cast<int>(mode.mode),
                      static_cast<int>(mode.fault),
                      static_cast<int>(mode.reaction),
                      static_cast<int>(mode.may_clear),
                      mode.cycles_in_mode,
                      mode.enabled_cycles,
                      static_cast<int>(brake.is_open),
                      brake.rest_cycles,
                      static_cast<int>(was_off)};
  }
};

struct WalkInput {
  ModeInput mode;
  BrakeInput brake;
};

/// What somebody or something asks for in every cycle, and where that has to lead to.
struct Demand {
  const char* name;
  bool (*is_made)(const WalkInput& input);
  bool (*is_met)(const WalkState& state);
  int most_cycles;
};

bool isStopped(const WalkState& state) {
  const bool may_move = isCommanding(state.mode.mode);
  return !may_move && !state.brake.is_open;
}

constexpr Demand kDemands[] = {
    {"a stop request leads to the end",
     [](const WalkInput& input) { return input.mode.stop_requested; },
     [](const WalkState& state) { return state.mode.mode == Mode::kOff; },
     2 * (kModeConfig.stopping_cycles + 1) + 1},
    {"silence of a drive leads to no setpoint but zero at once, and to closed brakes",
     [](const WalkInput& input) { return input.mode.fault == Fault::kDriveSilent; }, isStopped,
     kBrakeConfig.deadline_cycles + 1},
    {"a fault that ramps leads to rest and closed brakes",
     [](const WalkInput& input) { return input.mode.fault == Fault::kOverrun; }, isStopped,
     kModeConfig.stopping_cycles + kBrakeConfig.deadline_cycles + 2},
    {"a retreat ends, whatever else comes", [](const WalkInput&) { return true; },
     [](const WalkState& state) { return state.mode.mode != Mode::kRetreating; },
     kModeConfig.retreating_cycles + 1},
};

/// All that drives, lines and buses may say at once; a drive that holds is not off.
std::vector<WalkInput> allInputs(bool has_enable_line) {
  std::vector<WalkInput> inputs;
  for (const FaultRow& row : faultTable()) {
    for (unsigned bits = 0; bits < 1U << 10; ++bits) {
      const auto bit = [bits](int i) { return (bits >> i & 1U) != 0; };
      WalkInput input;
      input.mode.fault = row.fault;
      input.mode.has_enable_line = has_enable_line;
      input.mode.enable = bit(0) || !has_enable_line;
      input.mode.stop_requested = bit(1);
      input.mode.are_configured = bit(2);
      input.mode.are_enabled = input.brake.are_enabled = bit(3);
      input.mode.are_disabled = bit(4);
      input.mode.is_at_rest = bit(5);
      input.brake.is_at_rest = bit(6);
      input.brake.is_any_holding = bit(7);
      input.brake.is_any_moving_on = bit(8);
      input.mode.is_retreat_over = bit(9);
      const bool is_idle_bit = !has_enable_line && bit(0);
      if (is_idle_bit || (bit(4) && bit(7))) continue;
      inputs.push_back(input);
    }
  }
  return inputs;
}

/// The arm rests before it may move, and after its ramp.
bool canBe(const WalkState& state, const WalkInput& input) {
  const bool is_ramping =
      (state.mode.mode == Mode::kHolding || state.mode.mode == Mode::kStopping) &&
      state.mode.cycles_in_mode < kRampCycles;
  const bool may_move =
      state.mode.mode == Mode::kRunning || state.mode.mode == Mode::kRetreating || is_ramping;
  return may_move || input.mode.is_at_rest;
}

WalkState next(const WalkState& before, const WalkInput& input) {
  WalkState state = before;
  updateMode(kModeConfig, input.mode, state.mode);
  state.mode.cycles_in_mode = std::min(state.mode.cycles_in_mode, kLongest);
  updateBrake(kBrakeConfig, state.mode, input.brake, state.brake);
  const bool is_new_fault = input.mode.fault != Fault::kNone ||
                            (before.mode.fault == Fault::kNone && state.mode.fault != Fault::kNone);
  if (is_new_fault || state.mode.mode == Mode::kRunning) state.was_off = false;
  if (!input.mode.enable && input.mode.fault == Fault::kNone) state.was_off = true;
  return state;
}

class StoppingWalk : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override { walk(); }

  int add(const WalkState& state) {
    const auto [found, is_new] =
        numbers_.try_emplace(state.key(), static_cast<int>(states_.size()));
    if (is_new) states_.push_back(state);
    return found->second;
  }

  void walk() {
    add({});
    for (std::size_t i = 0; i < states_.size(); ++i) {
      std::array<std::set<int>, std::size(kDemands)> asked_for;
      for (const WalkInput& input : inputs_) {
        const WalkState before = states_[i];
        if (!canBe(before, input)) continue;
        const WalkState after = next(before, input);
        if (first_problem_ == nullptr) first_problem_ = problem(before, input, after);
        const int number = add(after);
        for (std::size_t k = 0; k < std::size(kDemands); ++k)
          if (kDemands[k].is_made(input)) asked_for[k].insert(number);
      }
      for (std::size_t k = 0; k < std::size(kDemands); ++k)
        next_[k].emplace_back(asked_for[k].begin(), asked_for[k].end());
    }
  }

  /// What must not be; nullptr if all is well.
  const char* problem(const WalkState& before, const WalkInput& input,
                      const WalkState& after) const {
    const ModeState& a = before.mode;
    const ModeState& b = after.mode;
    const bool is_cleared = a.fault != Fault::kNone && b.fault == Fault::kNone;
    if (a.mode != b.mode && !isLegal(a.mode, b.mode)) return "a change of mode beside the table";
    if (b.mode == Mode::kRunning && !input.mode.enable) return "running without enable";
    if (b.mode == Mode::kEnabling && a.mode != b.mode && !input.mode.enable)
      return "enabling without enable";
    if (b.mode == Mode::kRunning && b.fault != Fault::kNone) return "running with a fault";
    if (b.mode == Mode::kRunning && input.mode.stop_requested) return "running, asked to stop";
    if (input.mode.fault != Fault::kNone && a.mode != Mode::kOff && b.fault == Fault::kNone)
      return "a fault unseen";
    if (is_cleared && !(input.mode.has_enable_line && before.was_off && input.mode.enable))
      return "a fault forgotten without off and on";
    if (is_cleared && input.mode.fault != Fault::kNone) return "a fault forgotten that is there";
    if (b.mode == Mode::kRetreating && !input.mode.enable) return "a retreat without enable";
    if (b.mode == Mode::kRetreating && input.mode.stop_requested) return "a retreat, asked to stop";
    if (b.mode == Mode::kRetreating && b.fault == Fault::kNone) return "a retreat from nothing";
    if (b.mode == Mode::kRetreating && b.reaction != Reaction::kRetreat)
      return "a retreat from what ramps";
    if (a.mode == Mode::kHolding && b.mode == Mode::kRunning && !before.was_off)
      return "a hold that ends without off and on";
    if (!is_cleared && b.reaction < a.reaction) return "a milder reaction";
    if (b.reaction >= Reaction::kQuickStop && b.mode != Mode::kFault && b.mode != Mode::kOff)
      return "a quick stop that is none";
    return brakeProblem(before, input, after);
  }

  const char* brakeProblem(const WalkState& before, const WalkInput& input,
                           const WalkState& after) const {
    const ModeState& mode = after.mode;
    const bool is_open = after.brake.is_open;
    const bool opens = is_open && !before.brake.is_open;
    const bool holds = mode.mode == Mode::kRunning || mode.mode == Mode::kRetreating ||
                       mode.mode == Mode::kHolding ||
                       (mode.mode == Mode::kEnabling && input.brake.are_enabled);
    if (opens && !holds) return "a brake opens where nothing holds";
    if (is_open && mode.reaction == Reaction::kBrake) return "a brake open after an e-stop";
    if (mode.mode != Mode::kFault && mode.mode != Mode::kStopping && is_open != holds)
      return "a brake in the wrong state";
    if (mode.mode != Mode::kFault) return nullptr;
    if (is_open && mode.cycles_in_mode >= kBrakeConfig.deadline_cycles)
      return "a brake open beyond its deadline";
    if (is_open && input.brake.is_any_moving_on) return "a brake open while a drive moves on";
    if (is_open && !input.brake.is_any_holding) return "a brake open that nobody waits for";
    return nullptr;
  }

  /// The most cycles from any state to where a demand is met, whatever else comes meanwhile; -1:
  /// for ever.
  int cyclesTo(std::size_t demand) const {
    constexpr int kOpen = -1, kUnknown = -2;
    const std::vector<std::vector<int>>& edges = next_[demand];
    std::vector<int> most(states_.size(), kUnknown);
    std::vector<std::pair<int, std::size_t>> path;
    for (int start = 0; start < static_cast<int>(states_.size()); ++start) {
      if (most[start] == kUnknown) path.emplace_back(start, 0);
      while (!path.empty()) {
        auto& [state, edge] = path.back();
        const bool is_met = kDemands[demand].is_met(states_[state]);
        most[state] = is_met ? 0 : kOpen;
        if (is_met || edge == edges[state].size()) {
          for (const int to : edges[state])
            if (!is_met) most[state] = std::max(most[state], most[to] + 1);
          path.pop_back();
          continue;
        }
        const int to = edges[state][edge++];
        if (most[to] == kOpen) return -1;
        if (most[to] == kUnknown) path.emplace_back(to, 0);
      }
    }
    return *std::max_element(most.begin(), most.end());
  }

  std::vector<WalkInput> inputs_ = allInputs(GetParam());
  std::deque<WalkState> states_;
  std::map<decltype(WalkState{}.key()), int> numbers_;
  std::array<std::vector<std::vector<int>>, std::size(kDemands)> next_;  ///< while it is made
  const char* first_problem_ = nullptr;
};

TEST_P(StoppingWalk, NoStateIsUnsafeAndEachComesToTheEnd) {
  std::set<std::array<int, 6>> modes;
  std::set<int> faults;
  for (const WalkState& state : states_) {
    const auto key = state.key();
    modes.insert({key[0], key[1], key[2], key[3], key[4], key[5]});
    faults.insert(key[1]);
  }
  std::printf("%zu states, %zu of modes alone, %zu inputs each\n", states_.size(), modes.size(),
              inputs_.size());
  EXPECT_EQ(first_problem_, nullptr) << first_problem_;
  EXPECT_EQ(faults.size(), faultTable().size());
  for (std::size_t i = 0; i < std::size(kDemands); ++i) {
    const int cycles = cyclesTo(i);
    std::printf("%s: within %d cycles\n", kDemands[i].name, cycles);
    EXPECT_GE(cycles, 1) << kDemands[i].name;
    EXPECT_LE(cycles, kDemands[i].most_cycles) << kDemands[i].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Lines, StoppingWalk, testing::Bool(), [](const auto& has_enable_line) {
  return has_enable_line.param ? "WithEnableLine" : "WithoutOne";
});

TEST(ModeCount, DoesNotOverflowWhileAnArmRunsForMonths) {
  ModeState state;
  state.mode = Mode::kRunning;
  state.cycles_in_mode = kMaxCyclesInMode;
  updateMode({}, {}, state);
  EXPECT_EQ(state.cycles_in_mode, kMaxCyclesInMode);
}

}  // namespace
}  // namespace tactus
