#pragma once

#include <signal.h>

#include <array>

namespace tactus {

/// Hazard: what ends or suspends a process would leave brakes open and drives enabled, with nobody
/// who watches. Of a program that was started by hand the terminal sends SIGINT, SIGQUIT, and
/// SIGTSTP (Ctrl-Z).
inline constexpr std::array kStopSignals = {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGTSTP};
sigset_t stopSignals() noexcept;

/// None of them comes to this thread as long as this lives; what came acts then.
class HeldSignals {
 public:
  HeldSignals() noexcept;
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace tactus
