#include "tactus/plant/moteus_slave.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace tactus {
namespace {

// Modes and faults of github.com/mjbots/moteus, docs/protocol/registers.md.
constexpr int kStopped = 0, kFaulted = 1, kEnablingMode = 2, kPositionMode = 10;
constexpr int kTimeoutMode = 11, kZeroVelocityMode = 12;
constexpr double kModes = 256.0;
constexpr int kMotorDriverFault = 33;
constexpr double kMapVersion = 5.0;
constexpr double kDefaultWatchdog_s = 0.1;

int valueBytes(int type) { return type == 0 ? 1 : type == 1 ? 2 : 4; }

/// What one count of a register is as int8, int16 and int32.
double countOf(std::uint32_t number, int type) {
  static constexpr std::array<double, 3> kPosition = {0.01, 0.0001, 0.00001};
  static constexpr std::array<double, 3> kVelocity = {0.1, 0.00025, 0.00001};
  static constexpr std::array<double, 3> kTime = {0.01, 0.001, 0.000001};
  if (number == 0x001 || number == 0x020) return kPosition[type];
  if (number == 0x002 || number == 0x021) return kVelocity[type];
  if (number == 0x027) return kTime[type];
  return 1.0;
}

double fromBytes(const std::uint8_t* bytes, std::uint32_t number, int type) {
  std::uint32_t bits = 0;
  for (int i = 0; i < valueBytes(type); ++i) bits |= std::uint32_t{bytes[i]} << 8 * i;
  if (type == 3) {
    float value = 0.0F;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }
  const int unused = 32 - 8 * valueBytes(type);
  return (static_cast<std::int32_t>(bits << unused) >> unused) * countOf(number, type);
}

void toBytes(double value, std::uint32_t number, int type, CanFrame& frame) {
  std::uint32_t bits = 0;
  if (type == 3) {
    const auto single = static_cast<float>(value);
    std::memcpy(&bits, &single, sizeof(bits));
  } else {
    const double most = std::ldexp(1.0, 8 * valueBytes(type) - 1) - 1.0;
    const double counts = value / countOf(number, type);
    bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(
        std::isfinite(counts) ? std::clamp(std::round(counts), -most, most) : -most - 1.0));
  }
  for (int i = 0; i < valueBytes(type); ++i)
    frame.data[frame.size++] = static_cast<std::uint8_t>(bits >> 8 * i);
}

}  // namespace

MoteusSlave::MoteusSlave(const DriveConfig& config, double period_s)
    : config_(config), max_setpoint_age_ns_(std::llround(2e9 * period_s)) {}

void MoteusSlave::setPowered(bool is_on, std::int64_t) noexcept {
  is_powered_ = is_on;
  mode_ = kStopped;
  fault_ = 0;
  expires_ns_ = enabled_at_ns_ = kNever_ns;
  outbox_.clear();
  if (is_on && troubles_.is_failing) fail(kMotorDriverFault);
}

void MoteusSlave::setTroubles(const DriveTroubles& troubles) noexcept {
  if (troubles.freezes_feedback && !troubles_.freezes_feedback)
    frozen_ = {read(0x000), read(0x001), read(0x002)};
  troubles_ = troubles;
  if (troubles.is_failing) fail(kMotorDriverFault);
}

void MoteusSlave::receive(const QueuedFrame& item, std::int64_t t_ns) noexcept {
  const CanFrame& frame = item.frame;
  now_ns_ = t_ns;
  const bool is_mine = is_powered_ && frame.is_fd && frame.kind == FrameKind::kData &&
                       (frame.id & 0x7F) == static_cast<std::uint32_t>(config_.node_id) &&
                       (frame.id & 0xFF80) >> 15 == 1 && (frame.id >> 8 & 0x7F) == 0;
  if (!is_mine) return;
  CanFrame reply;
  reply.id = static_cast<std::uint32_t>(config_.node_id) << 8;
  reply.extended = reply.id > 0x7FF;
  reply.is_fd = true;
  if (!obeyFrame(frame, reply)) return;
  if (mode_ == kPositionMode && t_ns - item.sent_ns > max_setpoint_age_ns_) ++stale_setpoints_;
  while (reply.size != fdSize(reply.size)) reply.data[reply.size++] = 0x50;
  outbox_.push(reply);
}

void MoteusSlave::update(std::int64_t t_ns) noexcept {
  now_ns_ = t_ns;
  if (t_ns >= enabled_at_ns_) {
    enabled_at_ns_ = kNever_ns;
    if (mode_ == kEnablingMode) mode_ = kPositionMode;
  }
  if (t_ns >= expires_ns_) {
    expires_ns_ = kNever_ns;
    if (mode_ == kPositionMode) mode_ = kTimeoutMode;
  }
}

std::int64_t MoteusSlave::nextEvent_ns() const noexcept {
  return std::min(enabled_at_ns_, expires_ns_);
}

void MoteusSlave::move(double dt_s) noexcept {
  if (mode_ == kPositionMode) {
    velocity_ = config_.sign * commanded_turns_per_s_ / config_.counts_per_unit;
    return;
  }
  velocity_ = std::copysign(std::max(0.0, std::abs(velocity_) - kDeceleration * dt_s), velocity_);
}

void MoteusSlave::setPosition(double q) noexcept {
  position_turns_ = config_.sign * config_.counts_per_unit * (q - config_.offset);
}

PowerState MoteusSlave::powerState() const noexcept {
  if (!is_powered_) return PowerState::kNotReadyToSwitchOn;
  switch (mode_) {
    case kStopped:
      return PowerState::kSwitchOnDisabled;
    case kFaulted:
      return PowerState::kFault;
    case kPositionMode:
      return PowerState::kOperationEnabled;
    case kTimeoutMode:
    case kZeroVelocityMode:
      return PowerState::kQuickStopActive;
    default:
      return PowerState::kSwitchedOn;
  }
}

/// False for a frame that ends too soon, or that asks for something else.
bool MoteusSlave::obeyFrame(const CanFrame& frame, CanFrame& reply) noexcept {
  int at = 0;
  const auto has = [&](int bytes) { return at + bytes <= frame.size; };
  const auto varuint = [&] {
    std::uint32_t value = 0;
    for (int shift = 0; has(1) && shift < 32; shift += 7) {
      const std::uint8_t byte = frame.data[at++];
      value |= std::uint32_t{byte & 0x7FU} << shift;
      if ((byte & 0x80) == 0) break;
    }
    return value;
  };
  while (has(1)) {
    const std::uint8_t what = frame.data[at++];
    if (what == 0x50) continue;
    if (what >= 0x20) return false;
    const std::uint32_t count = (what & 3) != 0 ? what & 3U : varuint();
    const std::uint32_t first = varuint();
    const int type = what >> 2 & 3;
    if (what < 0x10) {
      for (std::uint32_t i = 0; i < count; ++i, at += valueBytes(type)) {
        if (!has(valueBytes(type))) return false;
        write(first + i, fromBytes(&frame.data[at], first + i, type));
      }
      continue;
    }
    const std::uint32_t room = kMaxFdBytes - std::min(reply.size + 4U, std::uint32_t{kMaxFdBytes});
    if (count > room / static_cast<std::uint32_t>(valueBytes(type))) return false;
    reply.data[reply.size++] = static_cast<std::uint8_t>(0x20 | type << 2 | (count & 3));
    if (first > 0x7F) reply.data[reply.size++] = static_cast<std::uint8_t>(0x80 | (first & 0x7F));
    reply.data[reply.size++] = static_cast<std::uint8_t>(first > 0x7F ? first >> 7 : first);
    for (std::uint32_t i = 0; i < count; ++i) toBytes(read(first + i), first + i, type, reply);
  }
  return true;
}

void MoteusSlave::write(std::uint32_t number, double value) noexcept {
  if (troubles_.ignores_commands) return;
  if (number == 0x000 && std::abs(value) < kModes) command(static_cast<int>(value));
  if (number == 0x021) commanded_turns_per_s_ = std::isfinite(value) ? value : 0.0;
  if (number != 0x027 || (mode_ != kPositionMode && mode_ != kEnablingMode)) return;
  const double watchdog_s = value > 0.0 ? value : kDefaultWatchdog_s;
  expires_ns_ = now_ns_ + std::llround(1e9 * watchdog_s);
}

void MoteusSlave::command(int mode) noexcept {
  if (mode == kStopped) {
    if (troubles_.is_failing) return;
    mode_ = kStopped;
    fault_ = 0;
    expires_ns_ = enabled_at_ns_ = kNever_ns;
    return;
  }
  if (mode_ == kFaulted || mode_ == kTimeoutMode) return;
  if (mode == kZeroVelocityMode) mode_ = mode;
  if (mode != kPositionMode || mode_ == kPositionMode || mode_ == kEnablingMode) return;
  mode_ = mode_ == kStopped ? kEnablingMode : kPositionMode;
  if (mode_ == kEnablingMode) enabled_at_ns_ = now_ns_ + kEnabling_ns;
}

double MoteusSlave::read(std::uint32_t number) const noexcept {
  const bool is_frozen = troubles_.freezes_feedback && number <= 0x002;
  if (number == 0x001 && troubles_.tells_nonsense) return std::numeric_limits<double>::quiet_NaN();
  if (is_frozen) return frozen_[number];
  switch (number) {
    case 0x000:
      return mode_;
    case 0x001:
      return position_turns_;
    case 0x002:
      return config_.sign * config_.counts_per_unit * velocity_;
    case 0x00C:
      return static_cast<double>(MoteusHome::kOutput);
    case 0x00F:
      return fault_;
    case 0x102:
      return kMapVersion;
    default:
      return 0.0;
  }
}

void MoteusSlave::fail(int code) noexcept {
  if (!is_powered_) return;
  mode_ = kFaulted;
  fault_ = code;
  expires_ns_ = enabled_at_ns_ = kNever_ns;
}

}  // namespace tactus
