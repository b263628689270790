#include "tactus/supervisor/tool_orders.h"

#include <algorithm>

#include "tactus/math/rotation.h"

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

/// From where the tool is, not on to where its reference waits.
bool leadsBack(const Pose& target, const ToolWatch& seen, const ToolMotion& motion) noexcept {
  const Pose& tool = seen.X_BaseTool;
  if (!seen.turn_waited_for_rad.isZero(0.0))
    return rotationVector(target.R_AB * tool.R_AB.transpose()).dot(seen.turn_waited_for_rad) <= 0.0;
  const Vector3 ahead = motion.evaluate(seen.path_time_s).p_BaseTool - tool.p_AB;
  return (target.p_AB - tool.p_AB).dot(ahead) <= 0.0;
}

}  // namespace

ToolOrders::ToolOrders(const TaskCommandsConfig& config) : config_(config), waiting_(kMaxWaiting) {}

void ToolOrders::order(const ToolOrder& order) noexcept {
  const bool is_next = order.kind == ToolOrder::Kind::kGoNext;
  // The rest of what was stopped.
  const bool is_over = report_.state == ToolState::kStopped && report_.number == order.number;
  if (is_next && (is_over || refused_ == order.number)) return;
  if (!is_next) count_ = 0;
  ToolOrder taken = order;
  if (count_ == kMaxWaiting) {
    count_ = 0;
    refused_ = order.number;
    taken.kind = ToolOrder::Kind::kHold;
  }
  waiting_[(first_ + count_) % kMaxWaiting] = taken;
  ++count_;
}

/// What was ordered is over.
void ToolOrders::forget() noexcept {
  if (count_ > 0) report_.number = waiting_[(first_ + count_ - 1) % kMaxWaiting].number;
  if (count_ > 0 || isUnderWay(report_.state)) report_.state = ToolState::kStopped;
  count_ = 0;
  silent_s_ = kNoLimit;  // a stream that had been given up has broken off
  paused_s_ = 0.0;
}

void ToolOrders::update(const ToolWatch& seen, ToolMotion& motion) noexcept {
  // Orders of before a stop may come late.
  if (!seen.is_running || (count_ > 0 && waiting_[first_].run != seen.run)) forget();
  paused_s_ = std::max(0.0, paused_s_ - seen.passed_s);
  silent_s_ += seen.passed_s;
  if (seen.is_running && !isReplaced()) watch(seen, motion);
  const bool is_free = !isUnderWay(report_.state) && paused_s_ <= 0.0;
  if (count_ > 0 && (waiting_[first_].kind != ToolOrder::Kind::kGoNext || is_free)) {
    const ToolOrder order = waiting_[first_];
    first_ = (first_ + 1) % kMaxWaiting;
    --count_;
    if (isGivenUp(order)) {
      silent_s_ = 0.0;
    } else {
      begin(order, seen, motion);
    }
  }
  report_.waiting = static_cast<int>(count_);
}

/// A stream has to break off before it may press again.
bool ToolOrders::isGivenUp(const ToolOrder& order) const noexcept {
  return report_.state == ToolState::kGivenUp && order.kind == ToolOrder::Kind::kStream &&
         current_.kind == ToolOrder::Kind::kStream && silent_s_ <= config_.stream_timeout_s;
}

void ToolOrders::begin(const ToolOrder& order, const ToolWatch& seen, ToolMotion& motion) noexcept {
  const bool streams_on = order.kind == ToolOrder::Kind::kStream &&
                          current_.kind == ToolOrder::Kind::kStream && isUnderWay(report_.state);
  current_ = order;
  paused_s_ = silent_s_ = 0.0;
  if (!streams_on) blocked_s_ = 0.0;
  const std::uint64_t number = motion.plan().number + 1;
  const bool is_held_off =
      seen.progress < kFreeProgress && (!streams_on || leadsBack(poseOf(order), seen, motion));
  if (is_held_off) motion = ToolMotion(seen.X_BaseTool, number);
  if (order.kind == ToolOrder::Kind::kHold) {
    if (!is_held_off) motion = motion.stop(seen.path_time_s, order.limits);
  } else {
    motion = motion.to(seen.path_time_s, poseOf(order), order.limits);
  }
  report_.number = order.number;
  if (streams_on && !is_held_off) return;  // blocked, too
  report_.state = order.kind == ToolOrder::Kind::kHold ? ToolState::kHolding : ToolState::kMoving;
}

/// By another order in this cycle, which giving up the one that is under way would throw away.
bool ToolOrders::isReplaced() const noexcept {
  using Kind = ToolOrder::Kind;
  if (count_ == 0) return false;
  const Kind next = waiting_[first_].kind;
  return next != Kind::kGoNext && !(next == Kind::kStream && current_.kind == Kind::kStream);
}

void ToolOrders::watch(const ToolWatch& seen, ToolMotion& motion) noexcept {
  if (!isUnderWay(report_.state)) return;
  if (current_.kind == ToolOrder::Kind::kStream && silent_s_ > config_.stream_timeout_s) {
    if (seen.progress < kFreeProgress) return rest(seen, ToolState::kLate, motion);
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
  blocked_s_ += seen.passed_s;
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
