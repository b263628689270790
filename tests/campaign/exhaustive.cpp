#include "campaign/exhaustive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "campaign/cases.h"
#include "campaign/run.h"
#include "campaign/share.h"
#include "tactus/scene/source_hash.h"

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

constexpr const char* kStamp = "# by the program ";

/// Of this program, by its bytes: what another one found says nothing of it.
std::string stampOfProgram() {
  std::ifstream program("/proc/self/exe", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(program), {}};
  return fmt::format("{}{:016x}", kStamp, sourceHash(bytes));
}

struct Done {
  std::set<std::string> names;
  int bad = 0;
};

/// Of whole lines: half of one, which a run that was killed has left, is cut off. nullopt: the file
/// is another one's.
std::optional<Done> takeUp(const std::string& path, const std::string& stamp) {
  std::ifstream file(path);
  Done done;
  std::string line;
  const bool is_there = static_cast<bool>(std::getline(file, line));
  if (is_there && !line.starts_with(kStamp)) return std::nullopt;
  if (line != stamp) {
    if (is_there) fmt::print("{}: of another program, begun anew\n", path);
    std::ofstream(path) << stamp << "\n";
    return done;
  }
  std::uintmax_t size = line.size() + 1;
  while (std::getline(file, line) && !file.eof()) {
    done.names.insert(line.substr(0, line.find('\t')));
    done.bad += line.ends_with("\t-") ? 0 : 1;
    size += line.size() + 1;
  }
  std::filesystem::resize_file(path, size);
  return done;
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
  const std::optional<Done> done = takeUp(options.results, stampOfProgram());
  if (!done) {
    fmt::print(stderr, "{}: holds no results of a campaign\n", options.results);
    return 2;
  }
  std::erase_if(cases, [&](const Case& one) { return done->names.contains(one.name); });
  std::FILE* file = std::fopen(options.results.c_str(), "a");
  if (file == nullptr) {
    fmt::print(stderr, "{}: cannot be written\n", options.results);
    return 1;
  }
  std::mutex mutex;
  int bad = done->bad;
  share(options.jobs, static_cast<int>(cases.size()), [&](int i) {
    const Result result = simulate(stage, cases[i].plan, false);
    const std::scoped_lock lock(mutex);
    fmt::print(file, "{}\n", lineOf(cases[i], result));
    std::fflush(file);
    bad += result.violations.empty() ? 0 : 1;
  });
  const bool is_written = std::ferror(file) == 0 && std::fclose(file) == 0;
  fmt::print("{} cases; {} were there; {} of both with violations\n", cases.size(),
             done->names.size(), bad);
  return bad == 0 && is_written ? 0 : 1;
}

}  // namespace tactus::campaign
