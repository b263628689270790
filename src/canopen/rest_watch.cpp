#include "tactus/canopen/rest_watch.h"

#include <cmath>

#include "tactus/canopen/cycle_count.h"

namespace tactus {

RestWatch::RestWatch(double period_s) : window_cycles_(cyclesCovering(kWindow_s, period_s)) {}

bool RestWatch::update(double position, int periods) noexcept {
  cycles_ += periods;
  if (has_begun_ && cycles_ < window_cycles_) return false;
  const double way = has_begun_ ? std::abs(position - begin_) * window_cycles_ / cycles_ : 0.0;
  const bool moves_on = has_way_before_ && way > kMoved && way > way_before_ - kSlowing;
  way_before_ = way;
  has_way_before_ = has_begun_;
  has_begun_ = true;
  cycles_ = 0;
  begin_ = position;
  return moves_on;
}

}  // namespace tactus
