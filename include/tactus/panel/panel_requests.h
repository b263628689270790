#pragma once

#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "tactus/panel/daemon_watch.h"
#include "tactus/panel/gain_check.h"
#include "tactus/scene/json.h"

namespace tactus {

/// An answer to a page: always an object, with `done`, and `error` where that is false.
struct PanelAnswer {
  int status = 200;  ///< of HTTP
  Json json;
};

/// What a page asks for besides events. From several threads.
class PanelRequests {
 public:
  explicit PanelRequests(const DaemonWatch& watch) : watch_(watch) {}

  /// Every gain's key with unit, symbol, meaning, range, and when a change begins.
  static Json keys();

  /// {"values": {KEY: TEXT}}: as GainCheck::check().
  PanelAnswer check(const std::string& body);

  /// What the daemon's socket takes, of set, undo, move and hold; and {"do": "save"}. With asked_s,
  /// when it was asked by the clock of DaemonWatch's now_s: what is older than 5 s is refused. A
  /// hold is always taken.
  static PanelAnswer act(const std::string& body);

 private:
  const DaemonWatch& watch_;
  std::mutex mutex_;  ///< one check at a time: it takes some tenths of a second
  GainCheck check_;
};

}  // namespace tactus
