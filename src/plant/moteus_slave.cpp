#include "tactus/plant/moteus_slave.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tactus/plant/slave_axis.h"

namespace tactus {
namespace {

// Modes and faults of github.com/mjbots/moteus, docs/protocol/registers.md.
constexpr int kStopped = 0, kFaulted = 1, kEnablingMode = 2, kPositionMode = 10;
constexpr int kTimeoutMode = 11, kZeroVelocityMode = 12;
constexpr double kModes = 16.0;
constexpr int kMotorDriverFault = 33;
constexpr double kMapVersion = 5.0;
constexpr double kDefaultWatchdog_s = 0.1;
constexpr double kFastest = 50.0;  // m/s or rad/s, towards a position that is far away

// Subframes: what is not done, and why.
constexpr std::uint8_t kWriteError = 0x30, kReadError = 0x31;
constexpr int kDone = 0, kUnknownRegister = 1, kNotWriteable = 2;
constexpr int kInt32 = 2;

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

void putVaruint(std::uint32_t value, CanFrame& frame) {
  for (; value > 0x7F; value >>= 7)
    frame.data[frame.size++] = static_cast<std::uint8_t>(0x80 | (value & 0x7F));
  frame.data[frame.size++] = static_cast<std::uint8_t>(value);
}

/// What does not fit into the frame any more is left out.
void putError(std::uint8_t what, std::uint32_t number, int reason, CanFrame& frame) {
  constexpr int kMostBytes = 1 + 5 + 1;
  if (frame.size + kMostBytes > kMaxFdBytes) return;
  frame.data[frame.size++] = what;
  putVaruint(number, frame);
  putVaruint(static_cast<std::uint32_t>(reason), frame);
}

}  // namespace

MoteusSlave::MoteusSlave(const DriveConfig& config, double period_s)
    : config_(config), max_setpoint_age_ns_(std::llround(2e9 * period_s)) {}

/// With the encoder of its rotor alone whole turns are gone with the power; of the output, where it
/// turns as the rotor.
void MoteusSlave::setPowered(bool is_on, std::int64_t) noexcept {
  const bool forgets = config_.home == MoteusHome::kRotor && is_powered_ && !is_on;
  if (forgets) forgotten_turns_ += std::trunc(position_turns_ - forgotten_turns_);
  is_powered_ = is_on;
  mode_ = kStopped;
  fault_ = 0;
  expires_ns_ = enabled_at_ns_ = kNever_ns;
  outbox_.clear();
  if (is_on && troubles_.is_failing) fail(kMotorDriverFault);
}

void MoteusSlave::setTroubles(const DriveTroubles& troubles) noexcept {
  if (troubles.freezes_feedback && !troubles_.freezes_feedback)
    frozen_ = {*read(0x000, kInt32), *read(0x001, kInt32), *read(0x002, kInt32)};
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
  command_ = {};
  const bool is_whole = obeyFrame(frame, reply);
  applyCommand();
  if (!is_whole) return;
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
  if (mode_ == kPositionMode) return follow(dt_s);
  const double deceleration =
      hasTorque(powerState()) ? kDeceleration : SlaveAxis::kCoastingDeceleration;
  velocity_ = std::copysign(std::max(0.0, std::abs(velocity_) - deceleration * dt_s), velocity_);
}

/// From where it is, or to the position that was commanded, at once.
void MoteusSlave::follow(double dt_s) noexcept {
  double turns_per_s = followed_.turns_per_s;
  if (std::isfinite(followed_.turns)) {
    turns_per_s = (followed_.turns - (position_turns_ - forgotten_turns_)) / dt_s;
    followed_.turns += followed_.turns_per_s * dt_s;
  }
  velocity_ = std::clamp(config_.sign * turns_per_s / config_.counts_per_unit, -kFastest, kFastest);
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

/// False for a frame that ends too soon, or that asks for something else. What has been written
/// before counts.
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
        const int result = write(first + i, fromBytes(&frame.data[at], first + i, type));
        if (result != kDone) putError(kWriteError, first + i, result, reply);
      }
      continue;
    }
    const Answer given = answer(first, count, what, reply);
    if (given != Answer::kWhole) return given == Answer::kError;  // and hears no more of the frame
  }
  return true;
}

/// All registers, or the error of the first that cannot be read.
MoteusSlave::Answer MoteusSlave::answer(std::uint32_t first, std::uint32_t count, std::uint8_t what,
                                        CanFrame& reply) const noexcept {
  const int type = what >> 2 & 3;
  constexpr int kMostHead = 1 + 5 + 5;
  const int room = kMaxFdBytes - kMostHead - reply.size;
  if (room < 0 || count > static_cast<std::uint32_t>(room / valueBytes(type)))
    return Answer::kNoRoom;
  const int start = reply.size;
  reply.data[reply.size++] = static_cast<std::uint8_t>(0x20 | (what & 0xF));
  if ((what & 3) == 0) putVaruint(count, reply);
  putVaruint(first, reply);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto value = read(first + i, type);
    if (!value) {
      reply.size = static_cast<std::uint8_t>(start);
      putError(kReadError, first + i, kUnknownRegister, reply);
      return Answer::kError;
    }
    toBytes(*value, first + i, type, reply);
  }
  return Answer::kWhole;
}

/// The mode comes first: what a frame says before it is forgotten, and without one it is nothing.
int MoteusSlave::write(std::uint32_t number, double value) noexcept {
  switch (number) {
    case 0x000:
      if (!(value >= 0.0 && value < kModes)) return kUnknownRegister;
      command_ = {.mode = static_cast<int>(value)};
      return kDone;
    case 0x020:
      command_.turns = value;
      return kDone;
    case 0x021:
      command_.turns_per_s = value;
      return kDone;
    case 0x027:
      command_.watchdog_s = value;
      return kDone;
    default:
      return read(number, kInt32) ? kNotWriteable : kUnknownRegister;
  }
}

void MoteusSlave::applyCommand() noexcept {
  if (troubles_.ignores_commands || !command_.mode) return;
  followed_ = command_;
  if (!std::isfinite(followed_.turns_per_s)) followed_.turns_per_s = 0.0;
  enter(*command_.mode);
  if (mode_ != kPositionMode && mode_ != kEnablingMode) return;
  const double watchdog_s =
      command_.watchdog_s == 0.0 ? kDefaultWatchdog_s : std::max(command_.watchdog_s, 0.0);
  expires_ns_ =
      std::isnan(command_.watchdog_s) ? kNever_ns : now_ns_ + std::llround(1e9 * watchdog_s);
}

void MoteusSlave::enter(int mode) noexcept {
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

/// Nothing of what there is not, or not as this type.
std::optional<double> MoteusSlave::read(std::uint32_t number, int type) const noexcept {
  const bool is_frozen = troubles_.freezes_feedback && number <= 0x002;
  if (number == 0x001 && troubles_.tells_nonsense) return std::numeric_limits<double>::quiet_NaN();
  if (is_frozen) return frozen_[number];
  switch (number) {
    case 0x000:
      return mode_;
    case 0x001:
      return position_turns_ - forgotten_turns_;
    case 0x002:
      return config_.sign * config_.counts_per_unit * velocity_;
    case 0x00C:
      return static_cast<double>(config_.home);
    case 0x00F:
      return fault_;
    case 0x102:
      if (type != kInt32) return std::nullopt;
      return kMapVersion;
    default:
      return std::nullopt;
  }
}

void MoteusSlave::fail(int code) noexcept {
  if (!is_powered_) return;
  mode_ = kFaulted;
  fault_ = code;
  expires_ns_ = enabled_at_ns_ = kNever_ns;
}

}  // namespace tactus
