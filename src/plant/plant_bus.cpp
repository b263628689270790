#include "tactus/plant/plant_bus.h"

#include <algorithm>
#include <cmath>

#include "tactus/canopen/bus_load.h"

namespace tactus {
namespace {

// linux/can/error.h: classes of an error frame, and the byte that details CAN_ERR_CRTL.
constexpr std::uint32_t kErrorController = 0x04;
constexpr std::uint32_t kErrorNoAcknowledgement = 0x20;
constexpr std::uint32_t kErrorBusOff = 0x40;
constexpr std::uint32_t kErrorRestarted = 0x100;
constexpr std::uint8_t kTransmitterPassive = 0x20;

// Each failed attempt adds 8 to the transmit error count; at 128 the controller becomes passive.
constexpr int kAttemptsUntilPassive = 16;
constexpr int kErrorFlagBits = 20;
constexpr std::int64_t kBetweenErrors_ns = 2'000'000;

CanFrame errorFrame(std::uint32_t error_class) noexcept {
  CanFrame frame;
  frame.id = error_class;
  frame.kind = FrameKind::kError;
  frame.size = 8;
  return frame;
}

/// The bits of arbitration, as a number: lower wins.
std::uint32_t arbitration(const CanFrame& frame) noexcept {
  const std::uint32_t id = frame.extended ? frame.id : frame.id << 18;
  return id << 2 | (frame.extended ? 2U : 0U) | (frame.kind == FrameKind::kRemote ? 1U : 0U);
}

}  // namespace

int worstCaseBits(const CanFrame& frame) noexcept {
  if (frame.is_fd) return worstCaseFdBits(frame.size, frame.extended).arbitration;
  const int data = frame.kind == FrameKind::kRemote ? 0 : frame.size;
  return (frame.extended ? 80 : 55) + 10 * data;
}

int worstCaseDataBits(const CanFrame& frame) noexcept {
  return frame.is_fd ? worstCaseFdBits(frame.size, frame.extended).data : 0;
}

CanFrame unacknowledgedError() noexcept {
  CanFrame frame = errorFrame(kErrorNoAcknowledgement | kErrorController);
  frame.data[1] = kTransmitterPassive;
  return frame;
}

CanFrame busOffError() noexcept { return errorFrame(kErrorBusOff); }

CanFrame busRestartedError() noexcept { return errorFrame(kErrorRestarted); }

bool FrameQueue::push(const QueuedFrame& item) noexcept {
  if (size_ == kCapacity) return false;
  items_[(first_ + size_++) % kCapacity] = item;
  return true;
}

void FrameQueue::pop() noexcept {
  first_ = (first_ + 1) % kCapacity;
  --size_;
}

PlantBus::PlantBus(double bit_rate_per_s, int nodes, std::optional<double> data_bit_rate_per_s)
    : bit_ns_(1e9 / bit_rate_per_s),
      data_bit_ns_(data_bit_rate_per_s ? 1e9 / *data_bit_rate_per_s : 0.0),
      queues_(static_cast<std::size_t>(nodes)) {}

bool PlantBus::send(int node, const CanFrame& frame, std::int64_t t_ns) noexcept {
  if (node != kOtherSide && !is_powered_) return false;
  const bool is_off = node == kOtherSide && is_other_side_off_;
  const bool is_carried = !frame.is_fd || data_bit_ns_ > 0.0;
  if (!is_off && is_carried && queues_[node].push({frame, t_ns})) return true;
  ++refused_;
  return false;
}

void PlantBus::setPowered(bool is_powered, std::int64_t t_ns) noexcept {
  if (is_powered == is_powered_) return;
  is_powered_ = is_powered;
  if (is_powered) {
    if (phase_ == Phase::kUnacknowledged) becomeIdle(t_ns);
    return;
  }
  for (std::size_t node = kOtherSide + 1; node < queues_.size(); ++node) queues_[node].clear();
  if (phase_ != Phase::kSending) return;
  if (sender_ == kOtherSide) {
    giveUp(t_ns);
  } else {
    becomeIdle(t_ns);
  }
}

void PlantBus::setOtherSideOff(bool is_off, std::int64_t t_ns) noexcept {
  if (is_off == is_other_side_off_) return;
  is_other_side_off_ = is_off;
  next_report_ns_ = t_ns;
  if (!is_off) return;
  queues_[kOtherSide].clear();
  if (phase_ != Phase::kIdle && sender_ == kOtherSide) becomeIdle(t_ns);
}

std::int64_t PlantBus::nextEvent_ns() const noexcept {
  return std::min(next_report_ns_, phase_ == Phase::kIdle ? nextStart_ns() : phase_end_ns_);
}

std::optional<BusDelivery> PlantBus::step() noexcept {
  const std::int64_t t_ns = nextEvent_ns();
  if (t_ns == next_report_ns_) return report(t_ns);
  if (phase_ == Phase::kIdle) {
    start(t_ns);
    return std::nullopt;
  }
  if (phase_ == Phase::kUnacknowledged) {
    phase_end_ns_ = t_ns + kBetweenErrors_ns;
    return BusDelivery{kController, {unacknowledgedError(), t_ns}};
  }
  const BusDelivery delivery{sender_, queues_[sender_].front()};
  queues_[sender_].pop();
  becomeIdle(t_ns);
  return delivery;
}

/// Once, as drivers tell it: who misses that knows it by its frames alone.
std::optional<BusDelivery> PlantBus::report(std::int64_t t_ns) noexcept {
  next_report_ns_ = kNever_ns;
  return BusDelivery{kController, {is_other_side_off_ ? busOffError() : busRestartedError(), t_ns}};
}

std::int64_t PlantBus::nextStart_ns() const noexcept {
  std::int64_t first_ns = kNever_ns;
  for (const FrameQueue& queue : queues_)
    if (!queue.empty()) first_ns = std::min(first_ns, queue.front().sent_ns);
  return first_ns == kNever_ns ? kNever_ns : std::max(first_ns, free_from_ns_);
}

void PlantBus::start(std::int64_t t_ns) noexcept {
  sender_ = kController;
  for (int node = 0; node < static_cast<int>(queues_.size()); ++node) {
    if (queues_[node].empty() || queues_[node].front().sent_ns > t_ns) continue;
    if (sender_ == kController ||
        arbitration(queues_[node].front().frame) < arbitration(queues_[sender_].front().frame))
      sender_ = node;
  }
  if (!is_powered_) {
    giveUp(t_ns);
    return;
  }
  phase_ = Phase::kSending;
  phase_end_ns_ = t_ns + duration_ns(queues_[sender_].front().frame);
}

void PlantBus::giveUp(std::int64_t t_ns) noexcept {
  phase_ = Phase::kUnacknowledged;
  phase_end_ns_ =
      t_ns + kAttemptsUntilPassive * duration_ns(queues_[sender_].front().frame, kErrorFlagBits);
}

void PlantBus::becomeIdle(std::int64_t t_ns) noexcept {
  phase_ = Phase::kIdle;
  free_from_ns_ = t_ns;
}

std::int64_t PlantBus::duration_ns(const CanFrame& frame, int more_bits) const noexcept {
  return std::llround((worstCaseBits(frame) + more_bits) * bit_ns_ +
                      worstCaseDataBits(frame) * data_bit_ns_);
}

}  // namespace tactus
