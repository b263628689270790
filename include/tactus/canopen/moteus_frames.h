#pragma once

#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"

/// Frames of mjbots' moteus controllers: registers that are written, read and replied to in
/// subframes of a CAN FD frame (docs/protocol/can.md and docs/protocol/registers.md in
/// github.com/mjbots/moteus). Turns are those of the output shaft as the controller is configured.
namespace tactus {

/// Register 0x000. What a command may set: kStopped, kPosition, kZeroVelocity.
enum class MoteusMode : std::uint8_t {
  kStopped = 0,  ///< no torque; commanding it clears a fault
  kFault = 1,    ///< no torque
  kEnabling = 2,
  kCalibrating = 3,
  kCalibrationComplete = 4,
  kPosition = 10,
  kTimeout = 11,       ///< the watchdog has expired; only kStopped leads out of it
  kZeroVelocity = 12,  ///< slows down, and damps; without a watchdog
  kBrake = 15,         ///< phases shorted
};

/// Register 0x102: the map of registers that all here is about.
inline constexpr std::int32_t kMoteusMap = 5;

namespace moteus_register {
inline constexpr std::uint16_t kMode = 0x000;
inline constexpr std::uint16_t kPosition = 0x001;
inline constexpr std::uint16_t kVelocity = 0x002;
inline constexpr std::uint16_t kHome = 0x00C;
inline constexpr std::uint16_t kFault = 0x00F;
inline constexpr std::uint16_t kCommandPosition = 0x020;
inline constexpr std::uint16_t kWatchdogTimeout = 0x027;
inline constexpr std::uint16_t kMapVersion = 0x102;
}  // namespace moteus_register

/// Bytes on the bus of the longest command and the longest reply.
inline constexpr int kMoteusCommandBytes = 32;
inline constexpr int kMoteusReplyBytes = 32;

/// What is sent to a controller in a cycle; each asks it to reply.
struct MoteusCommand {
  enum class Kind : std::uint8_t {
    kQuery,         ///< as it is
    kStop,          ///< kStopped
    kZeroVelocity,  ///< kZeroVelocity
    kVelocity,      ///< kPosition from where it is, at a velocity
  };
  Kind kind = Kind::kQuery;
  float velocity = 0.0F;        ///< turns/s
  float watchdog_s = 0.0F;      ///< of kVelocity: it stops by itself unless another comes within
  bool asks_for_setup = false;  ///< for the map of registers, and what the position refers to
};

/// Ids: a bit that asks for a reply, the sender (0), the node; 29 bits.
constexpr std::uint32_t moteusCommandId(int node_id) noexcept {
  return 0x8000U | static_cast<std::uint32_t>(node_id);
}
/// Of 11 bits where it fits into them.
constexpr std::uint32_t moteusReplyId(int node_id) noexcept {
  return static_cast<std::uint32_t>(node_id) << 8;
}

CanFrame moteusCommandFrame(int node_id, const MoteusCommand& command) noexcept;

/// A controller obeys what is in any frame whose id ends in its node or in this, whoever sent it:
/// of 11 bits or 29, classic or FD.
inline constexpr int kEveryMoteus = 127;
constexpr int moteusAddressOf(std::uint32_t id) noexcept { return static_cast<int>(id & 0xFF); }

/// What a controller replies; numbers as they came, which may be NaN.
struct MoteusReply {
  int mode = 0;
  double position = 0.0;  ///< turns
  double velocity = 0.0;  ///< turns/s
  int fault = 0;          ///< register 0x00F: of mode kFault, or what limits the torque
  std::optional<std::int32_t> map;
  std::optional<std::int32_t> home;  ///< as MoteusHome

  bool operator==(const MoteusReply&) const = default;
};

bool isMoteusReply(const CanFrame& frame, int node_id) noexcept;
/// Nothing if it is none of this node's, is malformed, or lacks one of the first four.
std::optional<MoteusReply> decodeMoteusReply(const CanFrame& frame, int node_id) noexcept;

}  // namespace tactus
