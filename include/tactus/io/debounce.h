#pragma once

namespace tactus {

/// A contact that bounces: a level counts once it has been read in as many cycles in a row as it
/// needs. Knows no clock.
class Debounce {
 public:
  /// Cycles that activation and release have to last; 0 and 1: the first reading counts.
  Debounce(int activation_cycles, int release_cycles, bool is_active) noexcept
      : activation_cycles_(activation_cycles),
        release_cycles_(release_cycles),
        is_active_(is_active) {}

  /// Once a cycle; returns isActive().
  bool update(bool level) noexcept;
  bool isActive() const noexcept { return is_active_; }

 private:
  int activation_cycles_;
  int release_cycles_;
  bool is_active_;
  int changed_cycles_ = 0;  ///< in a row in which the level was not is_active_
};

}  // namespace tactus
