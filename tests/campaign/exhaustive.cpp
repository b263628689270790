#include "campaign/exhaustive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "campaign/cases.h"
#include "campaign/run.h"
#include "campaign/share.h"

namespace tactus::campaign {
namespace {

/// Name; mode, fault and its reaction when the user comes; ms to rest; mode and fault at the end;
/// what was violated: between tabs.
std::string lineOf(const Case& one, const Result& result) {
  const std::string violated =
      result.violations.empty()
          ? "-"
          : fmt::format("{}: {} {}", result.violations.front().judge,
                        result.violations.front().what, result.violations.front().detail);
  const char* reaction = reactionName(faultRow(result.rest_fault).reaction);
  return fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}", one.name, modeName(result.rest_mode),
                     faultName(result.rest_fault), reaction, result.rest_ms, modeName(result.mode),
                     faultName(result.fault), violated);
}

/// Of whole lines: half of one, which a run that was killed has left, is cut off.
std::set<std::string> takeUp(const std::string& path) {
  std::ifstream file(path);
  std::set<std::string> names;
  std::uintmax_t size = 0;
  std::string line;
  while (std::getline(file, line) && !file.eof()) {
    names.insert(line.substr(0, line.find('\t')));
    size += line.size() + 1;
  }
  if (std::filesystem::exists(path)) std::filesystem::resize_file(path, size);
  return names;
}

int runOneCase(const Stage& stage, const std::vector<Case>& cases, const std::string& name) {
  const auto found =
      std::find_if(cases.begin(), cases.end(), [&](const Case& one) { return one.name == name; });
  if (found == cases.end()) {
    fmt::print(stderr, "no case '{}': --list names them\n", name);
    return 2;
  }
  fmt::print("{}\n", found->plan.text());
  const Result result = simulate(stage, found->plan, true);
  for (const Violation& violation : result.violations)
    fmt::print("{:6} ms  VIOLATION {}: {} {}\n", violation.t_ms, violation.judge, violation.what,
               violation.detail);
  fmt::print("{}\n", lineOf(*found, result));
  return result.violations.empty() ? 0 : 1;
}

}  // namespace

int listCases() {
  const std::vector<Case> cases = allCases(bootStage(kVariantOfAll));
  std::map<std::string, int> counts;
  for (const Case& one : cases) {
    fmt::print("{}\n", one.name);
    ++counts[one.name.substr(0, one.name.find(' '))];
  }
  for (const auto& [group, count] : counts) fmt::print(stderr, "{:6} {}\n", count, group);
  fmt::print(stderr, "{:6} in all\n", cases.size());
  return 0;
}

int runExhaustive(const ExhaustiveOptions& options) {
  const Stage stage = bootStage(kVariantOfAll);
  std::vector<Case> cases = allCases(stage);
  if (options.only) return runOneCase(stage, cases, *options.only);
  if (options.first) cases.resize(std::min(cases.size(), static_cast<std::size_t>(*options.first)));
  const std::set<std::string> done = takeUp(options.results);
  std::erase_if(cases, [&](const Case& one) { return done.contains(one.name); });
  std::FILE* file = std::fopen(options.results.c_str(), "a");
  if (file == nullptr) {
    fmt::print(stderr, "{}: cannot be written\n", options.results);
    return 1;
  }
  std::mutex mutex;
  int bad = 0;
  share(options.jobs, static_cast<int>(cases.size()), [&](int i) {
    const Result result = simulate(stage, cases[i].plan, false);
    const std::scoped_lock lock(mutex);
    fmt::print(file, "{}\n", lineOf(cases[i], result));
    std::fflush(file);
    bad += result.violations.empty() ? 0 : 1;
  });
  const bool is_written = std::ferror(file) == 0 && std::fclose(file) == 0;
  fmt::print("{} cases, {} with violations; {} were there\n", cases.size(), bad, done.size());
  return bad == 0 && is_written ? 0 : 1;
}

}  // namespace tactus::campaign
