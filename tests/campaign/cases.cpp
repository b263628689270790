#include "campaign/cases.h"

#include <algorithm>
#include <array>

#include "campaign/frame_cases.h"
#include "campaign/mode_cases.h"

namespace tactus::campaign {
namespace {

void mix(std::vector<Case>& cases) {
  test::Random random(1);
  for (std::size_t i = cases.size(); i > 1; --i)
    std::swap(cases[i - 1], cases[static_cast<std::size_t>(random.index(static_cast<int>(i)))]);
}

}  // namespace

std::vector<Case> allCases(const Stage& stage) {
  std::array<std::vector<Case>, 3> groups;
  addModeCases(stage, groups[0]);
  addPairCases(stage, groups[1]);
  addFrameCases(stage, groups[2]);
  std::size_t longest = 0;
  for (std::vector<Case>& group : groups) {
    mix(group);
    longest = std::max(longest, group.size());
  }
  std::vector<Case> cases;
  for (std::size_t i = 0; i < longest; ++i)
    for (const std::vector<Case>& group : groups)
      if (i < group.size()) cases.push_back(group[i]);
  return cases;
}

}  // namespace tactus::campaign
