#pragma once

#include <string>

#include "tactus/daemon/loop_figures.h"
#include "tactus/record/run_log.h"
#include "tactus/record/run_summary.h"
#include "tactus/scene/json.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// Where a daemon is, for people and scripts outside of it.
struct RunStatus {
  const Scene& scene;
  Mode mode;
  Fault fault;
  const std::string& description;  ///< of both, as describeMode()
  WayOn way_on;
  const LoopFigures& loop;        ///< cycles, missed and dropped ones, and times
  const RunFigures* figures;      ///< RunSummary::soFar(); nullptr before the arm first moves
  const LogState* log = nullptr;  ///< nullptr: a run without one
};

/// With the daemon's process and the machine's monotonic clock, by which a reader sees its age.
Json statusJson(const RunStatus& status, double monotonic_s);

/// The file that `tactus status` reads, replaced as a whole and removed at the end. It is in the
/// folder that the service manager makes (RuntimeDirectory=) and names in RUNTIME_DIRECTORY;
/// without that there is none.
class StatusFile {
 public:
  StatusFile();
  ~StatusFile();
  StatusFile(const StatusFile&) = delete;
  StatusFile& operator=(const StatusFile&) = delete;

  /// Whether it is time for another one.
  bool isDue() const noexcept;
  bool isWanted() const noexcept { return !path_.empty(); }
  /// A file that cannot be written ends no run: said once, and tried again when due.
  void write(const RunStatus& status);

 private:
  std::string path_;  ///< empty: none
  double written_s_ = -1e9;
  bool has_complained_ = false;
};

/// A file of the daemon that runs: in RUNTIME_DIRECTORY, or else where the service has its own.
std::string runtimePath(const char* name);

/// Name of the file in that folder.
inline constexpr const char* kStatusName = "status.json";

/// Where there is none.
inline constexpr const char* kNoDaemon =
    "no daemon is running here; `journalctl -u tactusd` says how a service ended, "
    "RUNTIME_DIRECTORY leads to any other";

/// CLOCK_MONOTONIC, s.
double monotonicTime_s() noexcept;

/// The daemon writes its status each half second.
inline constexpr double kMaxStatusAge_s = 2.0;

/// Of a status, s; infinite: it does not say when it was written, or it is of before this computer
/// started, when the clock was another.
double statusAge_s(const Json& status);

/// Why a status of that age is not that of a daemon that runs; empty: it is.
std::string ageProblem(double age_s);

}  // namespace tactus
