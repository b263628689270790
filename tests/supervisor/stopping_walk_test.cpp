#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <deque>
#include <map>
#include <set>
#include <vector>

#include "support/mode_walk.h"

/// Every state that modes and brakes can come to, over every input of every cycle, with time limits
/// of a few cycles: what holds there holds for ever.
namespace tactus {
namespace {

using test::canHappen, test::kWalkBrakes, test::kWalkModes, test::walkInputs, test::walkOn,
    test::WalkInput, test::WalkState;

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
     2 * (kWalkModes.stopping_cycles + 1) + 1},
    {"silence of a drive leads to no setpoint but zero at once, and to closed brakes",
     [](const WalkInput& input) { return input.mode.fault == Fault::kDriveSilent; }, isStopped,
     kWalkBrakes.deadline_cycles + 1},
    {"a fault that ramps leads to rest and closed brakes",
     [](const WalkInput& input) { return input.mode.fault == Fault::kOverrun; }, isStopped,
     kWalkModes.stopping_cycles + kWalkBrakes.deadline_cycles + 2},
    {"a retreat ends, whatever else comes", [](const WalkInput&) { return true; },
     [](const WalkState& state) { return state.mode.mode != Mode::kRetreating; },
     kWalkModes.retreating_cycles + 1},
};

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
        if (!canHappen(before, input)) continue;
        const WalkState after = walkOn(before, input);
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
    if (is_open && mode.cycles_in_mode >= kWalkBrakes.deadline_cycles)
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

  std::vector<WalkInput> inputs_ = walkInputs(GetParam());
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
