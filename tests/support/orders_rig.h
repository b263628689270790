#pragma once

#include <algorithm>

#include "tactus/supervisor/tool_orders.h"

namespace tactus::test {

inline constexpr double kOrdersPeriod_s = 0.001;

/// Orders, a reference, and a tool that follows it but for what the test says.
struct OrdersRig {
  TaskCommandsConfig config = [] {
    TaskCommandsConfig c;
    c.give_up_after_s = 2.0;
    return c;
  }();
  ToolOrders orders{config};
  ToolMotion motion{Pose{Matrix3::Identity(), Vector3::Zero()}};
  ToolWatch seen = [] {
    ToolWatch watch;
    watch.passed_s = kOrdersPeriod_s;
    watch.X_BaseTool = {Matrix3::Identity(), Vector3::Zero()};
    watch.is_running = true;
    return watch;
  }();
  bool is_held_off = false;
  double lag_rad = 0.0;  ///< that stays, whatever is done

  void step() {
    const ToolReference reference = motion.evaluate(seen.path_time_s);
    if (!is_held_off) seen.X_BaseTool = {reference.R_BaseTool, reference.p_BaseTool};
    seen.lag_m = (reference.p_BaseTool - seen.X_BaseTool.p_AB).norm();
    seen.lag_rad = lag_rad;
    seen.progress = is_held_off && seen.lag_m > 0.02 ? 0.0 : 1.0;
    seen.path_time_s += seen.progress * kOrdersPeriod_s;
    orders.update(seen, motion);
  }

  void run(double duration_s) {
    for (int i = 0; i < duration_s / kOrdersPeriod_s; ++i) step();
  }

  ToolState state() const { return orders.report().state; }
  Vector3 place() const { return motion.evaluate(seen.path_time_s).p_BaseTool; }
};

inline ToolOrder orderTo(const Vector3& p, std::uint32_t number,
                         ToolOrder::Kind kind = ToolOrder::Kind::kGo) {
  ToolOrder order;
  order.number = number;
  order.kind = kind;
  std::copy_n(p.data(), 3, order.p_BaseTool_m);
  return order;
}

}  // namespace tactus::test
