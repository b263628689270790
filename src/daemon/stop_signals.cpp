#include "tactus/daemon/stop_signals.h"

namespace tactus {

sigset_t stopSignals() noexcept {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : kStopSignals) sigaddset(&signals, signal);
  return signals;
}

HeldSignals::HeldSignals() noexcept {
  const sigset_t signals = stopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
}

HeldSignals::~HeldSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

}  // namespace tactus
