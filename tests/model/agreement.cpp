#include <algorithm>
#include <deque>
#include <istream>
#include <map>
#include <ostream>
#include <set>
#include <utility>
#include <vector>

#include "model/mode_model.h"
#include "support/mode_walk.h"

/// The model's states and steps beside those of the code.
namespace tactus::model {
namespace {

using Key = decltype(test::WalkState{}.key());
using Place = std::pair<bool, Key>;  ///< with an enable line or without
using Steps = std::set<std::pair<Place, Place>>;

constexpr std::size_t kFault = 1;  ///< its place in a key

test::WalkState stateOf(const Key& key) {
  test::WalkState state;
  state.mode = {static_cast<Mode>(key[0]),
                static_cast<Fault>(key[1]),
                static_cast<Reaction>(key[2]),
                key[3] != 0,
                key[4],
                key[5]};
  state.brake = {key[6] != 0, key[7]};
  state.was_off = key[8] != 0;
  return state;
}

Key asModel(Key key) {
  key[kFault] = static_cast<int>(representative(static_cast<Fault>(key[kFault])));
  return key;
}

std::ostream& operator<<(std::ostream& out, const Key& key) {
  for (const int number : key) out << number << ' ';
  return out;
}

/// Of the code, over every input and every fault, seen as the model tells them apart.
Steps stepsOfCode(bool has_enable_line) {
  const std::vector<test::WalkInput> inputs = test::walkInputs(has_enable_line);
  std::set<Key> known = {test::WalkState{}.key()};
  std::deque<Key> waiting(known.begin(), known.end());
  Steps steps;
  for (; !waiting.empty(); waiting.pop_front()) {
    const test::WalkState before = stateOf(waiting.front());
    std::set<Key> next;
    for (const test::WalkInput& input : inputs)
      if (test::canHappen(before, input)) next.insert(test::walkOn(before, input).key());
    for (const Key& key : next) {
      steps.insert({{has_enable_line, asModel(before.key())}, {has_enable_line, asModel(key)}});
      if (known.insert(key).second) waiting.push_back(key);
    }
  }
  return steps;
}

template <std::size_t N>
bool readNumbers(std::istream& in, std::array<int, N>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(),
                     [&](int& number) { return static_cast<bool>(in >> number); });
}

std::size_t statesOf(const Steps& steps) {
  std::set<Place> places;
  for (const auto& [from, to] : steps) places.insert({from, to});
  return places.size();
}

const std::pair<Place, Place>* missing(const Steps& in, const Steps& of) {
  const auto step = std::find_if(of.begin(), of.end(), [&](const auto& s) { return !in.count(s); });
  return step == of.end() ? nullptr : &*step;
}

}  // namespace

bool agrees(std::istream& steps, std::ostream& says) {
  Steps of_model;
  std::array<int, 1> line{};
  std::array<int, 2> told{};
  Key before, after;
  long long count = 0;
  for (; readNumbers(steps, line); ++count) {
    if (!readNumbers(steps, before) || !readNumbers(steps, told) || !readNumbers(steps, after)) {
      says << "step " << count << " is not whole\n";
      return false;
    }
    const bool has_line = line[0] != 0;
    const test::WalkInput input =
        test::walkInput(static_cast<Fault>(told[0]), static_cast<unsigned>(told[1]), has_line);
    const Key of_code = test::walkOn(stateOf(before), input).key();
    if (of_code != after) {
      says << "from " << before << "told " << told[0] << ' ' << told[1] << ", the model goes to "
           << after << ", the code to " << of_code << '\n';
      return false;
    }
    of_model.insert({{has_line, before}, {has_line, after}});
  }
  Steps of_code = stepsOfCode(false);
  of_code.merge(stepsOfCode(true));
  if (const auto* step = missing(of_model, of_code)) {
    says << "the code goes from " << step->first.second << "to " << step->second.second
         << ", the model never\n";
    return false;
  }
  if (const auto* step = missing(of_code, of_model)) {
    says << "the model goes from " << step->first.second << "to " << step->second.second
         << ", the code never\n";
    return false;
  }
  says << count << " steps told apart by inputs, " << of_code.size() << " by states, between "
       << statesOf(of_code) << " states: the same in model and code\n";
  return true;
}

}  // namespace tactus::model
