#include "tactus/daemon/service_notify.h"

#include "tactus/io/service_manager.h"

namespace tactus {
namespace {

/// Drives answer and are configured, the module is tared.
bool isUp(Mode mode) noexcept {
  return mode == Mode::kReady || mode == Mode::kEnabling || mode == Mode::kRunning ||
         mode == Mode::kRetreating || mode == Mode::kHolding;
}

}  // namespace

void ServiceNotify::onMode(Mode mode, const std::string& status) {
  is_up_ = is_up_ || isUp(mode);
  waiting_ = "STATUS=" + status;
  if (is_up_ && !is_ready_) waiting_ += "\nREADY=1";
  // The manager's time limit for a stop begins now, if it did not ask for the stop itself.
  if (mode == Mode::kOff) waiting_ += "\nSTOPPING=1";
  tellAgain();
}

void ServiceNotify::tellAgain() {
  if (waiting_.empty() || !tellManager(waiting_)) return;
  is_ready_ = is_up_;
  waiting_.clear();
}

}  // namespace tactus
