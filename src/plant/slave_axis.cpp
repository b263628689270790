#include "tactus/plant/slave_axis.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr std::uint32_t kVelocityMode = 9;
constexpr std::uint16_t kVoltageBit = 1U << 4;
constexpr std::uint16_t kQuickStopBit = 1U << 5;
constexpr std::uint16_t kRemoteBit = 1U << 9;
constexpr std::uint16_t kFollowsBit = 1U << 12;

std::uint32_t toCounts(double counts) {
  return static_cast<std::uint32_t>(
      static_cast<std::int32_t>(std::clamp(std::round(counts), -2147483648.0, 2147483647.0)));
}

/// In counts/s: 60FF and its offset 60B1, within 607F.
double followedVelocity(const ObjectDictionary& objects) noexcept {
  const double largest = objects.get(0x607F);
  const double offset = objects.getSigned(0x60B1);
  const double told = objects.getSigned(0x60FF) + offset;
  return std::clamp(told, -largest, largest);
}

/// Bit 5 is anything in these states; half of the drives set it.
bool tellsMoreThanItsState(int node_id, PowerState state) noexcept {
  const bool means_nothing =
      state == PowerState::kSwitchOnDisabled || state == PowerState::kFault ||
      state == PowerState::kFaultReactionActive || state == PowerState::kNotReadyToSwitchOn;
  return means_nothing && node_id % 2 == 0;
}

}  // namespace

void SlaveAxis::setPowered(bool is_on, ObjectDictionary& objects) noexcept {
  is_powered_ = is_on;
  had_reset_bit_ = false;
  state_ = is_on ? PowerState::kSwitchOnDisabled : PowerState::kNotReadyToSwitchOn;
  showStatus(objects);
}

bool SlaveAxis::obey(ObjectDictionary& objects, bool may_reset) noexcept {
  const auto word = static_cast<std::uint16_t>(objects.get(0x6040));
  const bool has_reset_bit = (word & 0x80) != 0;
  const bool is_reset_edge = has_reset_bit && !had_reset_bit_ && may_reset;
  had_reset_bit_ = has_reset_bit;
  const bool was_in_fault = state_ == PowerState::kFault;
  state_ = commanded(state_, word, is_reset_edge);
  showStatus(objects);
  return was_in_fault && state_ != PowerState::kFault;
}

bool SlaveAxis::fail(ObjectDictionary& objects) noexcept {
  if (!is_powered_ || state_ == PowerState::kFault || state_ == PowerState::kFaultReactionActive)
    return false;
  state_ = PowerState::kFaultReactionActive;
  showStatus(objects);
  return true;
}

void SlaveAxis::move(double dt_s, ObjectDictionary& objects) noexcept {
  if (follows(objects)) {
    velocity_ = config_.sign * followedVelocity(objects) / config_.counts_per_unit;
  } else {
    const double slower = std::max(0.0, std::abs(velocity_) - deceleration(objects) * dt_s);
    velocity_ = std::copysign(slower, velocity_);
    if (slower == 0.0) state_ = atStandstill(state_);
  }
  objects.set(0x606C, 0, toCounts(config_.sign * config_.counts_per_unit * velocity_));
  showStatus(objects);
}

void SlaveAxis::setPosition(double q, ObjectDictionary& objects) const noexcept {
  objects.set(0x6064, 0, toCounts(config_.sign * config_.counts_per_unit * (q - config_.offset)));
}

bool SlaveAxis::follows(const ObjectDictionary& objects) const noexcept {
  return state_ == PowerState::kOperationEnabled && objects.get(0x6060) == kVelocityMode;
}

double SlaveAxis::deceleration(const ObjectDictionary& objects) const noexcept {
  if (!hasTorque(state_)) return kCoastingDeceleration;
  return objects.get(0x6085) / config_.counts_per_unit;
}

void SlaveAxis::showStatus(ObjectDictionary& objects) const noexcept {
  std::uint16_t word = stateBits(state_);
  if (is_powered_) word |= kVoltageBit | kRemoteBit;
  if (follows(objects)) word |= kFollowsBit;
  if (tellsMoreThanItsState(config_.node_id, state_)) word |= kQuickStopBit;
  objects.set(0x6041, 0, word);
  objects.set(0x6061, 0, objects.get(0x6060));
}

}  // namespace tactus
