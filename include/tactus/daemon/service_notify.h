#pragma once

#include <string>

#include "tactus/supervisor/mode.h"

namespace tactus {

/// Tells the service manager where the daemon is. A manager that hangs must not hold up the log or
/// the end: it is told the newest once it reads again.
class ServiceNotify {
 public:
  /// A change of mode, each in its turn. `status` describes it to people, in one line.
  void onMode(Mode mode, const std::string& status);
  /// Now and then: what found no room.
  void tellAgain();

 private:
  bool is_up_ = false;
  bool is_ready_ = false;  ///< and has been told
  std::string waiting_;    ///< to be told; empty: nothing
};

}  // namespace tactus
