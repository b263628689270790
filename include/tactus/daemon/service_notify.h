#pragma once

#include <string>
#include <string_view>

#include "tactus/supervisor/mode.h"

namespace tactus {

/// A word to the service manager, by the protocol of sd_notify(3), but without waiting where it
/// does not read: false, it has no room for more at present. True without a NOTIFY_SOCKET in the
/// environment, or where nobody listens there.
bool tellManager(std::string_view state) noexcept;

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
