#include "tactus/daemon/service_notify.h"

#include <systemd/sd-daemon.h>

namespace tactus {
namespace {

/// Drives answer and are configured, the module is tared.
bool isUp(Mode mode) noexcept {
  return mode == Mode::kReady || mode == Mode::kEnabling || mode == Mode::kRunning ||
         mode == Mode::kRetreating || mode == Mode::kHolding;
}

}  // namespace

void ServiceNotify::onMode(Mode mode, const std::string& status) {
  std::string state = "STATUS=" + status;
  if (!is_ready_ && isUp(mode)) {
    is_ready_ = true;
    state += "\nREADY=1";
  }
  // The manager's time limit for a stop begins now, if it did not ask for the stop itself.
  if (mode == Mode::kOff) state += "\nSTOPPING=1";
  sd_notify(0, state.c_str());  // a manager that has gone must not end the run
}

}  // namespace tactus
