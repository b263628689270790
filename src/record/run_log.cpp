#include "tactus/record/run_log.h"

#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <system_error>
#include <utility>

#include "tactus/record/message.h"
#include "tactus/record/run_error.h"
#include "tactus/record/ulog_format.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr double kLookPeriod_s = 1.0;

/// One who still reads the log of a run that was killed keeps that file: in the same one, begun
/// anew, he would go on in the middle of this run. What is no file, as a device, is written to.
void removeLogBefore(const std::string& path) {
  std::error_code error;
  if (fs::is_regular_file(fs::symlink_status(path, error))) fs::remove(path, error);
}

std::string newRunName() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

[[noreturn]] void failTo(const char* what, const std::string& path, const std::string& why) {
  throw RunError(fmt::format("{}: cannot be {}: {}", path, what, why));
}

void rename(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::rename(from, to, error);
  const bool is_missing = error == std::errc::no_such_file_or_directory;  // somebody tidied up
  if (error && !is_missing) failTo("renamed", from, error.message());
}

}  // namespace

std::string logName(int age) { return age == 0 ? "run.ulg" : fmt::format("run.{}.ulg", age); }

Json logJson(const LogState& state, const char* unless_stopped) {
  Json json = {{"state", state.stop_reason.empty() ? unless_stopped : "stopped"}};
  if (!state.stop_reason.empty()) json["reason"] = state.stop_reason;
  json["files"] = state.files;
  json["removed_files"] = state.removed_files;
  return json;
}

RunLog::RunLog(const Scene& scene, std::string folder)
    : config_(scene.log), folder_(std::move(folder)), description_(describeLog(scene)) {
  state_.folder = fs::absolute(folder_).string();
  description_.infos.emplace_back(kRunKey, newRunName());
  description_.infos.emplace_back(kPartKey, "0");
  removeLogBefore(folder_ + "/" + logName(0));
  writer_ = begin(folder_ + "/" + logName(0));
  attempt([this] { keepReserve(); });
}

void RunLog::write(const CycleRecord& record) {
  attempt([&] {
    const auto size = static_cast<double>(writer_->size() + writer_->sizeOf(record));
    if (config_.max_bytes > 0.0 && size > config_.max_bytes) beginNextFile();
    writer_->write(record);
    t_s_ = record.t_s;
  });
}

void RunLog::flush() {
  attempt([this] {
    writer_->flush();
    if (t_s_ - looked_s_ < kLookPeriod_s) return;
    looked_s_ = t_s_;
    keepReserve();
    writer_->requireName();
  });
}

void RunLog::close() {
  attempt([this] {
    writer_->requireName();
    writer_->close();
  });
  writer_.reset();
}

template <typename Step>
void RunLog::attempt(const Step& step) {
  if (!writer_) return;
  try {
    step();
  } catch (const std::exception& error) {
    stop(error.what());
  }
}

void RunLog::stop(const std::string& reason) {
  state_.stop_reason = reason;
  writer_.reset();
  say("log stopped, the run goes on: {}", reason);
}

std::unique_ptr<UlogWriter> RunLog::begin(const std::string& path) {
  auto writer = std::make_unique<UlogWriter>(path, description_);
  writer->flush();
  return writer;
}

/// Whenever this ends, by an error or with the process, all files that have cycles are complete.
void RunLog::beginNextFile() {
  const std::string next = folder_ + "/" + kNextLogName;
  try {
    description_.infos.back().second = fmt::to_string(part_ + 1);
    std::unique_ptr<UlogWriter> writer = begin(next);
    writer_->flush();
    shiftFiles();
    writer->rename(next, folder_ + "/" + logName(0));
    writer_.swap(writer);  // open until the next has its name: who follows it waits for that
    writer->close();
  } catch (const std::exception&) {
    std::error_code ignored;
    fs::remove(next, ignored);
    throw;
  }
  ++part_;
}

void RunLog::shiftFiles() {
  const auto path = [this](int age) { return folder_ + "/" + logName(age); };
  if (state_.files > config_.keep) {
    const std::string oldest = path(config_.keep);
    std::error_code error;
    fs::remove(oldest, error);
    if (error) failTo("removed", oldest, error.message());
    --state_.files;
    ++state_.removed_files;
  }
  for (int age = state_.files; age > 0; --age) rename(path(age - 1), path(age));
  ++state_.files;
}

void RunLog::keepReserve() const {
  if (config_.min_free_bytes <= 0.0) return;
  struct statvfs disk {};
  if (::statvfs(folder_.c_str(), &disk) != 0) failTo("looked at", folder_, std::strerror(errno));
  const double free_bytes = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  if (free_bytes >= config_.min_free_bytes) return;
  throw RunError(fmt::format("{}: {:.0f} bytes are free, log.min_free_bytes is {:.0f}", folder_,
                             free_bytes, config_.min_free_bytes));
}

}  // namespace tactus
