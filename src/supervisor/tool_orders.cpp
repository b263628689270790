#include "tactus/supervisor/tool_orders.h"

#include <algorithm>

namespace tactus {
namespace {

/// Of the reference's clock: below this the tool is held off.
constexpr double kBlockedProgress = 0.5;
/// The tool follows its reference with a lag that dies away within this.
constexpr double kArrivalTime_s = 1.0;

bool isUnderWay(ToolState state) {
  return state == ToolState::kMoving || state == ToolState::kBlocked;
}

Pose poseOf(const ToolOrder& order) noexcept {
  return {Eigen::Map<const Matrix3>(order.R_BaseTool),
          Eigen::Map<const Vector3>(order.p_BaseTool_m)};
}

}  // namespace

ToolOrders::ToolOrders(const TaskCommandsConfig& config, double period_s)
    : config_(config), period_s_(period_s), waiting_(kMaxWaiting) {}

void ToolOrders::order(const ToolOrder& order) noexcept {
  const bool is_next = order.kind == ToolOrder::Kind::kGoNext;
  // The rest of what was stopped.
  if (is_next && report_.state == ToolState::kStopped && report_.number == order.number) return;
  if (!is_next) count_ = 0;
  if (count_ == kMaxWaiting) {
    report_ = {order.number, ToolState::kStopped, 0};
    count_ = 0;
    current_.kind = ToolOrder::Kind::kHold;
    return;
  }
  waiting_[(first_ + count_) % kMaxWaiting] = order;
  ++count_;
}

void ToolOrders::update(const ToolWatch& seen, ToolMotion& motion) noexcept {
  if (!seen.is_running) {
    // What was under way is over; what comes meanwhile is not begun.
    if (count_ > 0) report_.number = waiting_[(first_ + count_ - 1) % kMaxWaiting].number;
    if (count_ > 0 || isUnderWay(report_.state)) report_.state = ToolState::kStopped;
    count_ = 0;
    report_.waiting = 0;
    return;
  }
  watch(seen, motion);
  const bool is_next = count_ > 0 && waiting_[first_].kind == ToolOrder::Kind::kGoNext;
  const bool is_free = !isUnderWay(report_.state) && paused_s_ <= 0.0;
  if (count_ > 0 && (!is_next || is_free)) {
    const ToolOrder order = waiting_[first_];
    first_ = (first_ + 1) % kMaxWaiting;
    --count_;
    begin(order, seen, motion);
  }
  report_.waiting = static_cast<int>(count_);
}

void ToolOrders::begin(const ToolOrder& order, const ToolWatch& seen, ToolMotion& motion) noexcept {
  current_ = order;
  blocked_s_ = paused_s_ = silent_s_ = 0.0;
  const std::uint64_t number = motion.plan().number + 1;
  const bool is_held_off = seen.progress < 1.0;
  if (is_held_off) motion = ToolMotion(seen.X_BaseTool, number);
  if (order.kind == ToolOrder::Kind::kHold) {
    if (!is_held_off) motion = motion.stop(seen.path_time_s, order.limits);
  } else {
    motion = motion.to(seen.path_time_s, poseOf(order), order.limits);
  }
  report_.number = order.number;
  report_.state = order.kind == ToolOrder::Kind::kHold ? ToolState::kHolding : ToolState::kMoving;
}

void ToolOrders::watch(const ToolWatch& seen, ToolMotion& motion) noexcept {
  paused_s_ = std::max(0.0, paused_s_ - period_s_);
  if (!isUnderWay(report_.state)) return;
  silent_s_ += period_s_;
  if (current_.kind == ToolOrder::Kind::kStream && silent_s_ > config_.stream_timeout_s) {
    if (seen.progress < 1.0) return rest(seen, ToolState::kLate, motion);
    motion = motion.stop(seen.path_time_s, current_.limits);
    report_.state = ToolState::kLate;
    return;
  }
  if (isThere(seen, motion)) {
    report_.state = ToolState::kArrived;
    paused_s_ = current_.pause_s;
    return;
  }
  const bool should_be_there = seen.path_time_s > motion.end_s() + kArrivalTime_s;
  if (seen.progress >= kBlockedProgress && !should_be_there) {
    report_.state = ToolState::kMoving;
    blocked_s_ = 0.0;
    return;
  }
  report_.state = ToolState::kBlocked;
  blocked_s_ += period_s_;
  if (blocked_s_ > config_.give_up_after_s) rest(seen, ToolState::kGivenUp, motion);
}

/// Where the tool is.
void ToolOrders::rest(const ToolWatch& seen, ToolState state, ToolMotion& motion) noexcept {
  motion = ToolMotion(seen.X_BaseTool, motion.plan().number + 1);
  count_ = 0;
  report_.state = state;
}

bool ToolOrders::isThere(const ToolWatch& seen, const ToolMotion& motion) const noexcept {
  return seen.path_time_s >= motion.end_s() && seen.lag_m <= config_.arrival_m &&
         seen.lag_rad <= config_.arrival_rad;
}

}  // namespace tactus
