#pragma once

#include <string>

#include "tactus/supervisor/mode.h"

namespace tactus {

/// Tells the service manager where the daemon is, by the protocol of sd_notify(3). Does nothing
/// unless the environment names the manager's NOTIFY_SOCKET.
class ServiceNotify {
 public:
  /// A change of mode, each in its turn. `status` describes it to people, in one line.
  void onMode(Mode mode, const std::string& status);

 private:
  bool is_ready_ = false;
};

}  // namespace tactus
