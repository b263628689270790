#pragma once

#include <optional>
#include <string>
#include <utility>

#include "tactus/commission/commission_cycle.h"

namespace tactus {

/// Where commissioning runs: the cycle with its buses and lines, and an engineer who reads and
/// types. On real ones, or in virtual time.
class CommissionDesk {
 public:
  virtual ~CommissionDesk() = default;

  /// Waits for the next cycle and runs it.
  virtual void runCycle() = 0;
  virtual CommissionCycle& cycle() = 0;
  /// Ends the motion that goes on, in the next cycle.
  virtual void stopMotion() = 0;
  /// A fault of a bus, by its index, since the last call.
  virtual std::optional<std::pair<int, Fault>> takeBusFault() = 0;

  virtual void say(const std::string& text) = 0;
  /// A line that was typed, without its end.
  virtual std::optional<std::string> takeLine() = 0;
  /// What was typed so far answers nothing that is asked from now on.
  virtual void forgetTyped() = 0;
  /// For good: nothing is typed any more, or the program shall end.
  virtual bool isStopped() const = 0;
};

}  // namespace tactus
