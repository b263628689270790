#include "tactus/record/log_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "tactus/record/run_log.h"
#include "tactus/record/ulog_format.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

[[noreturn]] void failIn(const std::string& path, const char* key, const std::string& problem,
                         const std::string& expectation) {
  failAt(beginOf(path), key, problem, expectation);
}

std::string infoOf(const LogDescription& description, const char* name) {
  const auto info =
      std::ranges::find(description.infos, name, &std::pair<std::string, std::string>::first);
  return info == description.infos.end() ? "" : info->second;
}

}  // namespace

LogPart logPart(const LogDescription& description, const std::string& path) {
  LogPart part{infoOf(description, kRunKey), 0};
  const std::string text = infoOf(description, kPartKey);
  if (text.empty()) return part;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), part.part);
  if (error != std::errc() || end != text.data() + text.size() || part.part < 0)
    failIn(path, kPartKey, inQuotes(text) + " is not a part's number", "expected 0, 1 and so on");
  return part;
}

bool isOfRun(const LogDescription& description, const std::string& path,
             std::optional<std::string>& run) {
  const std::string found = logPart(description, path).run;
  // One by tactus simulate has no name, and one file.
  if (run && (found.empty() || found != *run)) return false;
  run = found;
  return true;
}

std::vector<std::string> logsOfRun(const std::string& newest) {
  const std::filesystem::path folder = std::filesystem::path(newest).parent_path();
  std::vector<std::string> paths;
  for (int age = kMaxKeptLogs; age > 0; --age) {
    const std::filesystem::path path = folder / logName(age);
    if (std::filesystem::exists(path)) paths.push_back(path.string());
  }
  paths.push_back(newest);
  return paths;
}

std::vector<std::ifstream> openLogs(const std::vector<std::string>& paths) {
  std::vector<std::ifstream> files;
  for (const std::string& path : paths) files.push_back(openLog(path));
  return files;
}

void checkOrder(const std::string& path, const LogPart& part, const std::string& path_before,
                const LogPart& before) {
  if (part.run.empty() || part.run != before.run) {
    failIn(path, kRunKey, "is not of the same run as " + inQuotes(path_before),
           "expected the logs of one run of tactusd");
  }
  if (part.part <= before.part) {
    failIn(path, kPartKey, fmt::format("part {} of the run behind part {}", part.part, before.part),
           "expected the oldest first, as in run.2.ulg run.1.ulg run.ulg");
  }
}

std::vector<LogExtent> checkParts(const std::vector<std::string>& paths) {
  std::vector<LogExtent> extents;
  LogPart before;
  long long cycles = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    std::ifstream in = openLog(paths[i]);
    UlogReader reader(in, paths[i]);
    const LogPart part = logPart(reader.description(), paths[i]);
    if (i > 0) checkOrder(paths[i], part, paths[i - 1], before);
    before = part;
    extents.push_back(readToEnd(reader));
    cycles += extents.back().cycles;
  }
  if (cycles == 0) refuseEmptyLog(paths.back());
  return extents;
}

}  // namespace tactus
