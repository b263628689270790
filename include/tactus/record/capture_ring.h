#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "tactus/record/trigger.h"

namespace tactus {

/// What was recorded around a trigger.
struct Capture {
  double trigger_s = 0.0;            ///< time of the log; of one without a trigger its last cycle's
  bool is_triggered = true;          ///< false: the newest cycles, without a trigger
  std::vector<CycleRecord> records;  ///< from lead_s + pre_s before the trigger to post_s behind it
  double from_s = -kNoLimit;         ///< where pre_s begins
};

struct CaptureWindow {
  double pre_s = 0.3, post_s = 2.0;  ///< >= 0
  double hysteresis = 0.0, holdoff_s = 0.0;
  double lead_s = 0.0;  ///< of what is not wanted itself, but says what led to it
};

/// Keeps the newest cycles, and hands them out around each trigger once what comes behind it is
/// there, too. Until then there is no further trigger. Memory is that of lead_s + pre_s + post_s.
/// Time that goes back, as of another run, begins anew.
class CaptureRing {
 public:
  CaptureRing(TriggerCondition condition, const CaptureWindow& window);

  std::optional<Capture> add(const CycleRecord& record);
  /// At the end of a run: the one that has had its trigger, but not all of its time.
  std::optional<Capture> unfinished() const;
  /// Whether there was a trigger, and what comes behind it is not there yet.
  bool isWaiting() const noexcept { return trigger_s_.has_value(); }
  /// What there is now, without a trigger.
  Capture newest() const;

 private:
  Capture around(double trigger_s, bool is_triggered) const;

  TriggerCondition condition_;
  CaptureWindow window_;
  TriggerLevel level_;
  Trigger trigger_;
  std::deque<CycleRecord> recent_;
  std::optional<double> trigger_s_;  ///< of the one that is not complete
};

}  // namespace tactus
