#pragma once

#include <array>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tactus/panel/force_bins.h"
#include "tactus/record/contact_figures.h"
#include "tactus/record/contact_watch.h"
#include "tactus/record/growing_file.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/json.h"

namespace tactus {

/// The files and settings that a run began with.
struct RunStart {
  std::vector<SourceFile> sources;
  std::vector<Override> overrides;
};

/// What has come since the last look.
struct LogNews {
  std::vector<ForceBin> bins;      ///< nothing while the past is still being read
  std::vector<Json> contacts;      ///< that are over, as contactJson() with a "trace" at the touch
  std::vector<Json> lasting;       ///< contacts that last, likewise
  std::optional<Gains> gains;      ///< of the last cycle
  std::vector<std::string> links;  ///< of the tactile modules
  bool is_live = false;
  std::string problem;  ///< why nothing more will come; empty: it does
};

/// Reads a log that a daemon writes, in a thread of its own, from its begin on and as long as it
/// grows.
class LogFollower {
 public:
  explicit LogFollower(std::string path);

  const std::string& path() const noexcept { return path_; }
  LogNews news();
  /// Once the log's definitions were read.
  std::optional<RunStart> start() const;

 private:
  void follow(const std::stop_token& stop);
  bool readFile(const std::stop_token& stop);
  void add(const CycleRecord& record, bool is_live);
  Json contact(const ContactFigures& figures);
  Json trace(const ContactSummary& contact) const;

  const std::string path_;
  std::optional<ContactWatch> watch_;  ///< of the thread alone, as the two below
  ForceBins bins_;
  double lasting_s_ = 0.0;  ///< when contacts that last were looked at

  mutable std::mutex mutex_;
  std::optional<GrowingFile> file_;  ///< made anew under the lock, read without
  std::deque<ForceBin> past_;        ///< for the traces
  /// Of long contacts the trace at the touch, which is not among those any more.
  // NOLINTNEXTLINE(bugprone-exception-escape): of a JSON that is null
  struct Begun {
    double start_s = -1.0;
    Json trace;
  };
  std::array<Begun, kMaxTactileModules> begun_;
  LogNews news_;
  std::optional<RunStart> start_;
  std::jthread thread_;  ///< the last member: it uses all others
};

}  // namespace tactus
