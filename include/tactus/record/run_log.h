#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "tactus/record/ulog_writer.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What has become of a run's log.
struct LogState {
  std::string folder;       ///< of all its files
  int files = 1;            ///< run.ulg and the older ones that are still there
  int removed_files = 0;    ///< the oldest ones, for LogConfig::keep
  std::string stop_reason;  ///< empty: the log has not stopped before the run
};

/// The member "log" of summary.json and status.json. `unless_stopped` is its state then.
Json logJson(const LogState& state, const char* unless_stopped);

/// A daemon's log: run.ulg, and what was cut off it when it had grown to LogConfig::max_bytes, as
/// run.1.ulg (the newest of them), run.2.ulg and so on. Each file has all definitions; infos `run`
/// and `part` say what belongs together. What goes wrong stops the log, once and for good, and
/// never the run; what is in the files by then stays readable.
class RunLog {
 public:
  /// `folder` exists. Throws InputError or RunError if run.ulg cannot be begun.
  RunLog(const Scene& scene, std::string folder);

  void write(const CycleRecord& record);

  /// Hands all that was written to the kernel, so that it survives this process. About once a
  /// second of the log's time looks at what is left of the disk, and whether the file is there.
  void flush();

  void close();

  const LogState& state() const noexcept { return state_; }

 private:
  template <typename Step>
  void attempt(const Step& step);
  void stop(const std::string& reason);
  std::unique_ptr<UlogWriter> begin(const std::string& path);
  void beginNextFile();
  void shiftFiles();
  void keepReserve() const;

  LogConfig config_;
  std::string folder_;
  LogDescription description_;
  int part_ = 0;
  double t_s_ = 0.0;       ///< of the last cycle
  double looked_s_ = 0.0;  ///< when the disk was looked at, likewise
  LogState state_;
  std::unique_ptr<UlogWriter> writer_;  ///< nullptr: stopped or closed
};

/// The next file until it is complete up to its first cycle. Only a daemon that is killed just then
/// leaves it.
inline constexpr const char* kNextLogName = "run.next.ulg";

/// run.ulg, or an older file of the same run: run.1.ulg for `age` 1.
std::string logName(int age);

}  // namespace tactus
