#include "tactus/record/run_folder.h"

#include <unistd.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "tactus/record/run_log.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummaryName = "summary.json";

[[noreturn]] void failAtOutput(const fs::path& path, const std::string& problem,
                               const std::string& expectation) {
  failAt(beginOf(path.string()), "-o", problem, expectation);
}

void removeEarlier(const fs::path& path, const std::string& expectation) {
  std::error_code error;
  fs::remove(path, error);
  if (error) failAtOutput(path, "cannot be replaced: " + error.message(), expectation);
}

}  // namespace

void checkRunName(const std::string& name) {
  if (!name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos) return;
  failAt(beginOf(name), "--name", inQuotes(name) + " is no name",
         "expected that of one folder, without /");
}

fs::path prepareRunFolder(const std::string& directory, const std::string& name) {
  if (directory.empty()) failAtOutput("", "no folder", "expected a path");
  const fs::path folder = fs::path(directory) / name;
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && ::access(folder.c_str(), W_OK | X_OK) != 0) {
    error = {errno, std::generic_category()};
  }
  if (error) {
    failAtOutput(folder, "cannot be written to: " + error.message(),
                 "expected a folder or room to make one");
  }
  removeEarlier(folder / kSummaryName, "expected an earlier summary or nothing");
  removeEarlier(folder / kNextLogName, "expected an earlier log or nothing");
  for (int age = 1; age <= kMaxKeptLogs; ++age)
    removeEarlier(folder / logName(age), "expected an earlier log or nothing");
  return folder;
}

}  // namespace tactus
