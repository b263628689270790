#include "tactus/canopen/moteus_frames.h"

#include <cstring>
#include <limits>

namespace tactus {
namespace {

namespace number_of = moteus_register;

// Subframes: what is done, with the type of the values (0: int8, 4: int16, 8: int32, 12: float)
// and their number, if that is 1 to 3.
constexpr std::uint8_t kWrite = 0x00;
constexpr std::uint8_t kRead = 0x10;
constexpr std::uint8_t kReply = 0x20;
constexpr std::uint8_t kWriteError = 0x30, kReadError = 0x31;
constexpr std::uint8_t kNop = 0x50;
constexpr std::uint8_t kInt8 = 0, kInt32 = 8, kFloat = 12;

/// Appends subframes to a frame.
class SubframeWriter {
 public:
  explicit SubframeWriter(CanFrame& frame) noexcept : frame_(frame) {}

  void begin(std::uint8_t what, std::uint8_t type, std::uint8_t count,
             std::uint16_t first) noexcept {
    put(static_cast<std::uint8_t>(what | type | count));
    if (first > 0x7F) put(static_cast<std::uint8_t>(0x80 | (first & 0x7F)));
    put(static_cast<std::uint8_t>(first > 0x7F ? first >> 7 : first));
  }
  void put(std::uint8_t byte) noexcept { frame_.data[frame_.size++] = byte; }
  void put(float value) noexcept {
    std::uint32_t bits = 0;
    static_assert(sizeof(bits) == sizeof(value));
    std::memcpy(&bits, &value, sizeof(bits));
    for (int i = 0; i < 4; ++i) put(static_cast<std::uint8_t>(bits >> 8 * i));
  }
  void writeMode(MoteusMode mode) noexcept {
    begin(kWrite, kInt8, 1, number_of::kMode);
    put(static_cast<std::uint8_t>(mode));
  }
  void pad() noexcept {
    while (frame_.size != fdSize(frame_.size)) put(kNop);
  }

 private:
  CanFrame& frame_;
};

/// Takes a frame apart; false once it has ended too soon.
class SubframeReader {
 public:
  explicit SubframeReader(const CanFrame& frame) noexcept : frame_(frame) {}

  bool isAtEnd() const noexcept { return at_ >= frame_.size; }
  bool isGood() const noexcept { return is_good_; }

  std::uint32_t bytes(int count) noexcept {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) value |= static_cast<std::uint32_t>(byte()) << 8 * i;
    return value;
  }
  std::uint32_t varuint() noexcept {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 7) {
      const std::uint8_t next = byte();
      value |= static_cast<std::uint32_t>(next & 0x7F) << shift;
      if ((next & 0x80) == 0) return value;
    }
    is_good_ = false;
    return 0;
  }

 private:
  std::uint8_t byte() noexcept {
    if (isAtEnd()) is_good_ = false;
    return is_good_ ? frame_.data[at_++] : std::uint8_t{0};
  }

  const CanFrame& frame_;
  int at_ = 0;
  bool is_good_ = true;
};

/// A value as it came, and its unit in integers of its type.
struct Value {
  std::uint32_t bits = 0;
  int type = kInt8;

  std::int32_t integer() const noexcept {
    const int unused = type == kInt8 ? 24 : type == kInt32 ? 0 : 16;
    return static_cast<std::int32_t>(bits << unused) >> unused;
  }
  /// units: of one count as int8, int16 and int32. The most negative integer is NaN.
  double scaled(const std::array<double, 3>& units) const noexcept {
    if (type == kFloat) {
      float value = 0.0F;
      std::memcpy(&value, &bits, sizeof(value));
      return value;
    }
    const int width = type / 4;
    const std::int32_t lowest =
        width == 2 ? std::numeric_limits<std::int32_t>::min() : -(1 << (width == 0 ? 7 : 15));
    const std::int32_t value = integer();
    if (value == lowest) return std::numeric_limits<double>::quiet_NaN();
    return value * units[static_cast<std::size_t>(width)];
  }
  /// Of a register that holds whole numbers; a float may hold them, too.
  std::int32_t whole() const noexcept {
    if (type != kFloat) return integer();
    const double value = scaled({});
    return value > -1e9 && value < 1e9 ? static_cast<std::int32_t>(value) : -1;
  }
};

/// What has been found of a reply.
struct FoundRegisters {
  MoteusReply reply;
  bool has_mode = false, has_position = false, has_velocity = false, has_fault = false;

  void take(std::uint32_t number, const Value& value) noexcept {
    constexpr std::array<double, 3> kTurns = {0.01, 0.0001, 0.00001};
    constexpr std::array<double, 3> kTurns_per_s = {0.1, 0.00025, 0.00001};
    if (number == number_of::kMode) {
      reply.mode = value.whole();
      has_mode = true;
    } else if (number == number_of::kPosition) {
      reply.position = value.scaled(kTurns);
      has_position = true;
    } else if (number == number_of::kVelocity) {
      reply.velocity = value.scaled(kTurns_per_s);
      has_velocity = true;
    } else if (number == number_of::kFault) {
      reply.fault = value.whole();
      has_fault = true;
    } else if (number == number_of::kMapVersion) {
      reply.map = value.whole();
    } else if (number == number_of::kHome) {
      reply.home = value.whole();
    }
  }
  bool isWhole() const noexcept { return has_mode && has_position && has_velocity && has_fault; }
};

bool readSubframe(SubframeReader& reader, FoundRegisters& found) noexcept {
  const auto what = static_cast<std::uint8_t>(reader.bytes(1));
  if (what == kNop) return true;
  if (what == kWriteError || what == kReadError) {  // of a register, with a number that tells why
    reader.varuint();
    reader.varuint();
    return reader.isGood();
  }
  if ((what & 0xF0) != kReply) return false;
  const std::uint32_t count = (what & 3) != 0 ? what & 3U : reader.varuint();
  const std::uint32_t first = reader.varuint();
  const int type = what & 12;
  const int bytes = type == kInt8 ? 1 : type == 4 ? 2 : 4;
  for (std::uint32_t i = 0; i < count && reader.isGood(); ++i) {
    const Value value{reader.bytes(bytes), type};
    if (reader.isGood()) found.take(first + i, value);
  }
  return reader.isGood();
}

}  // namespace

CanFrame moteusCommandFrame(int node_id, const MoteusCommand& command) noexcept {
  using Kind = MoteusCommand::Kind;
  CanFrame frame;
  frame.id = moteusCommandId(node_id);
  frame.extended = frame.is_fd = true;
  SubframeWriter writer(frame);
  if (command.kind == Kind::kStop) writer.writeMode(MoteusMode::kStopped);
  if (command.kind == Kind::kZeroVelocity) writer.writeMode(MoteusMode::kZeroVelocity);
  if (command.kind == Kind::kVelocity) {
    writer.writeMode(MoteusMode::kPosition);
    writer.begin(kWrite, kFloat, 2, number_of::kCommandPosition);
    writer.put(std::numeric_limits<float>::quiet_NaN());
    writer.put(command.velocity);
    writer.begin(kWrite, kFloat, 1, number_of::kWatchdogTimeout);
    writer.put(command.watchdog_s);
  }
  writer.begin(kRead, kInt8, 1, number_of::kMode);
  writer.begin(kRead, kFloat, 2, number_of::kPosition);
  writer.begin(kRead, kInt8, 1, number_of::kFault);
  if (command.asks_for_setup) {
    writer.begin(kRead, kInt8, 1, number_of::kHome);
    writer.begin(kRead, kInt32, 1, number_of::kMapVersion);  // read as no other type
  }
  writer.pad();
  return frame;
}

bool isMoteusReply(const CanFrame& frame, int node_id) noexcept {
  return frame.kind == FrameKind::kData && frame.is_fd && frame.id == moteusReplyId(node_id);
}

std::optional<MoteusReply> decodeMoteusReply(const CanFrame& frame, int node_id) noexcept {
  if (!isMoteusReply(frame, node_id) || frame.size > kMaxFdBytes) return std::nullopt;
  SubframeReader reader(frame);
  FoundRegisters found;
  while (!reader.isAtEnd())
    if (!readSubframe(reader, found)) return std::nullopt;
  if (!found.isWhole()) return std::nullopt;
  return found.reply;
}

}  // namespace tactus
