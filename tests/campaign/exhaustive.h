#pragma once

#include <optional>
#include <string>

namespace tactus::campaign {

struct ExhaustiveOptions {
  std::string results;              ///< a line a case; those that are there are not run again
  std::optional<int> first;         ///< so many cases of the mixed order
  std::optional<std::string> only;  ///< this case alone, with what happens
  int jobs = 1;
};

int listCases();
/// 0: nothing was violated.
int runExhaustive(const ExhaustiveOptions& options);

}  // namespace tactus::campaign
