#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "tactus/panel/event_feed.h"
#include "tactus/panel/log_follower.h"
#include "tactus/panel/panel_state.h"

namespace tactus {

/// Looks at the daemon ten times a second, whether there is one or not: its status, its control
/// socket and its log. Tells what is new as events, each with now_s: when by the clock of this
/// machine.
class DaemonWatch {
 public:
  explicit DaemonWatch(EventFeed& feed);

  /// All that there is, and the number of the newest event in it.
  std::pair<std::string, std::uint64_t> all() const;
  /// An event of nothing new.
  static std::string signOfLife();
  /// Of the log that is followed.
  std::optional<RunStart> start() const;

 private:
  /// What the daemon says at its socket, and when it said so.
  // NOLINTNEXTLINE(bugprone-exception-escape): of a JSON that is null
  struct Said {
    Json shown;
    std::string problem;
    double at_s = 0.0;
  };

  void ask(const std::stop_token& stop);
  void watch(const std::stop_token& stop);
  void look();
  void tellProblem(const std::string& problem);
  void publish(const Json& event);
  void followLog(const Json& status);
  Json state(const Json& status, double age_s, const LogNews& news) const;
  std::string problem(const Json& status, double age_s) const;
  bool isSaid() const;

  EventFeed& feed_;
  mutable std::mutex mutex_;
  Said said_;
  std::unique_ptr<LogFollower> log_;
  std::string run_;  ///< which daemon and which log
  Json cycles_;      ///< of that daemon, when it was looked at last
  int restarts_ = 0;
  PanelState panel_;
  std::jthread asking_, watching_;  ///< the last members: they use all others
};

}  // namespace tactus
