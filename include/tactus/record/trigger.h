#pragma once

#include "tactus/record/trigger_condition.h"

namespace tactus {

struct TriggerLevel {
  Comparison comparison = Comparison::kAbove;
  double level = 0.0;
  double hysteresis = 0.0;  ///< >= 0
  double holdoff_s = 0.0;   ///< >= 0
};

/// The trigger of an oscilloscope: it fires where the condition begins to hold, if it is armed
/// then. It is armed by a value that does not hold even against a level that is nearer by the
/// hysteresis: of > level where it is at most level - hysteresis. So the first value never fires,
/// nor does one that swings by less than the hysteresis. Within holdoff_s of the last one it does
/// not fire, and what begins then is not made up for. NaN neither arms nor fires.
class Trigger {
 public:
  explicit Trigger(const TriggerLevel& config) noexcept : config_(config) {}

  /// Values in the order of their time.
  bool update(double t_s, double value) noexcept;

 private:
  bool holds(double value, double level) const noexcept;

  TriggerLevel config_;
  bool is_armed_ = false;
  bool has_fired_ = false;
  double fired_s_ = 0.0;
};

}  // namespace tactus
