#include "tactus/canopen/rest_watch.h"

#include <cmath>

#include "tactus/canopen/cycle_count.h"

namespace tactus {

RestWatch::RestWatch(double period_s) : window_cycles_(cyclesCovering(kWindow_s, period_s)) {}

bool RestWatch::update(double position) noexcept {
  if (cycles_ == 0) begin_ = position;
  if (cycles_++ < window_cycles_) return false;
  const double way = std::abs(position - begin_);
  const bool moves_on = windows_ > 0 && way > kMoved && way > way_before_ - kSlowing;
  way_before_ = way;
  windows_ = 1;
  cycles_ = 1;
  begin_ = position;
  return moves_on;
}

}  // namespace tactus
