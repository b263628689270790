#include "campaign/cases.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "campaign/frame_cases.h"
#include "campaign/mode_cases.h"

namespace tactus::campaign {
namespace {

void mix(std::vector<Case>& cases) {
  test::Random random(1);
  for (std::size_t i = cases.size(); i > 1; --i)
    std::swap(cases[i - 1], cases[static_cast<std::size_t>(random.index(static_cast<int>(i)))]);
}

/// The line of docs/campaign.md to which a case adds.
std::string rowOf(const std::string& name) {
  const bool is_pair = name.starts_with("pair");
  return name.substr(0, is_pair ? name.find(' ', name.find(' ') + 1) : name.rfind(' '));
}

/// One case of each row, then a second one of each, and so on.
void takeTurns(std::vector<Case>& cases) {
  std::map<std::string, int> counts;
  std::vector<std::pair<int, Case>> turns;
  for (Case& one : cases) turns.emplace_back(counts[rowOf(one.name)]++, std::move(one));
  std::stable_sort(turns.begin(), turns.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < cases.size(); ++i) cases[i] = std::move(turns[i].second);
}

}  // namespace

Plan latePlan(const Stage& stage, Moment moment, Ending ending, const char* kind, int from_ms,
              int until_ms) {
  Plan plan;
  plan.moment = moment;
  plan.ending = ending;
  plan.comes_late = true;
  plan.attempts = 2;
  plan.go_on_ms = 700;
  if (kind == nullptr) return plan;
  test::Random random(1);
  Injection x = drawInjection(random, stage.scene, kindOf(kind), from_ms);
  x.until_ms = until_ms;
  plan.injections.push_back(x);
  return plan;
}

std::vector<Case> allCases(const Stage& stage) {
  std::array<std::vector<Case>, 3> groups;
  addModeCases(stage, groups[0]);
  addPairCases(stage, groups[1]);
  addFrameCases(stage, groups[2]);
  std::size_t longest = 0;
  for (std::vector<Case>& group : groups) {
    mix(group);
    takeTurns(group);
    longest = std::max(longest, group.size());
  }
  std::vector<Case> cases;
  for (std::size_t i = 0; i < longest; ++i)
    for (const std::vector<Case>& group : groups)
      if (i < group.size()) cases.push_back(group[i]);
  return cases;
}

}  // namespace tactus::campaign
