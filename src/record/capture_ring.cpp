#include "tactus/record/capture_ring.h"

#include <algorithm>
#include <utility>

namespace tactus {
namespace {

/// Times are multiples of a period with rounding errors; far below any period.
constexpr double kRounding_s = 1e-9;

}  // namespace

CaptureRing::CaptureRing(TriggerCondition condition, const CaptureWindow& window)
    : condition_(std::move(condition)),
      window_(window),
      level_{condition_.comparison, condition_.level, window.hysteresis, window.holdoff_s},
      trigger_(level_) {}

std::optional<Capture> CaptureRing::add(const CycleRecord& record) {
  if (!recent_.empty() && record.t_s < recent_.back().t_s) {
    recent_.clear();
    trigger_s_.reset();
    trigger_ = Trigger(level_);
  }
  recent_.push_back(record);
  const bool has_fired = trigger_.update(record.t_s, signalOf(condition_, record));
  if (has_fired && !trigger_s_) trigger_s_ = record.t_s;
  std::optional<Capture> complete;
  if (trigger_s_ && record.t_s >= *trigger_s_ + window_.post_s - kRounding_s) {
    complete = around(*trigger_s_, true);
    trigger_s_.reset();
  }
  const double kept_s = window_.lead_s + window_.pre_s + window_.post_s + kRounding_s;
  while (recent_.front().t_s < record.t_s - kept_s) recent_.pop_front();
  return complete;
}

std::optional<Capture> CaptureRing::unfinished() const {
  if (!trigger_s_) return std::nullopt;
  return around(*trigger_s_, true);
}

Capture CaptureRing::newest() const {
  return around(recent_.empty() ? 0.0 : recent_.back().t_s, false);
}

Capture CaptureRing::around(double trigger_s, bool is_triggered) const {
  const double before_s = window_.pre_s + (is_triggered ? 0.0 : window_.post_s);
  const double from_s = trigger_s - before_s - kRounding_s;
  const auto first = std::ranges::find_if(
      recent_, [&](const CycleRecord& record) { return record.t_s >= from_s - window_.lead_s; });
  return {trigger_s, is_triggered, {first, recent_.end()}, from_s};
}

}  // namespace tactus
