#include "tactus/record/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
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

namespace {

fs::path makeFolder(const std::string& directory, const std::string& name) {
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
  return folder;
}

void removeEarlierFrom(const fs::path& folder) {
  removeEarlier(folder / kSummaryName, "expected an earlier summary or nothing");
  removeEarlier(folder / kNextLogName, "expected an earlier log or nothing");
  for (int age = 1; age <= kMaxKeptLogs; ++age)
    removeEarlier(folder / logName(age), "expected an earlier log or nothing");
}

}  // namespace

FolderHold::FolderHold(const std::string& folder) noexcept
    : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (fd_ >= 0) is_elsewhere_ = ::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

FolderHold::~FolderHold() {
  if (fd_ >= 0) ::close(fd_);
}

RunFolder::RunFolder(const std::string& directory, const std::string& name)
    : path_(makeFolder(directory, name)), hold_(path_) {
  if (hold_.isElsewhere())
    failAtOutput(path_, "another run writes there", "expected another folder");
  removeEarlierFrom(path_);
}

}  // namespace tactus
