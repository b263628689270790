#include "soak/replay_sample.h"

#include <fmt/format.h>

#include <filesystem>

#include "tactus/record/run_log.h"
#include "tactus/run/log_replay.h"
#include "tactus/scene/input_error.h"

namespace tactus::soak {
namespace {

/// The oldest first.
std::vector<std::string> logsIn(const std::string& folder) {
  std::vector<std::string> logs;
  for (int age = kMaxKeptLogs; age >= 0; --age) {
    const std::string path = folder + "/" + logName(age);
    if (std::filesystem::exists(path)) logs.push_back(path);
  }
  return logs;
}

}  // namespace

std::vector<std::string> replaySample(const std::string& folder, long long at_least,
                                      ReplayCounts& counts) {
  const std::vector<std::string> logs = logsIn(folder);
  ++counts.samples;
  counts.files += static_cast<long long>(logs.size());
  try {
    const ReplayResult result =
        replayLogs({.logs = logs, .settings = {}, .output = {}}, [](double) {});
    const ReplayComparison& comparison = result.comparison;
    counts.cycles += comparison.cycles();
    counts.skipped += comparison.skipped();
    if (comparison.cycles() + comparison.skipped() < at_least)
      return {fmt::format("log: {} cycles of {}", comparison.cycles() + comparison.skipped(),
                          at_least)};
    if (comparison.differingCycles() == 0) return {};
    const ReplayDifference& first = *comparison.first();
    return {fmt::format("replay: {} cycles differ, first at {:.9g} s: {} was {:.17g}, is {:.17g}",
                        comparison.differingCycles(), first.t_s, first.column, first.recorded,
                        first.replayed)};
  } catch (const MissingPartsError&) {
    // A reference that has waited goes on where it was, which the parts that are left do not tell.
    ++counts.unknown;
    return {};
  } catch (const InputError& error) {
    return {std::string("log: ") + error.what()};
  }
}

}  // namespace tactus::soak
