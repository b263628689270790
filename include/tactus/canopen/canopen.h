#pragma once

#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"

/// Messages of CiA 301 (CANopen application layer, version 4.2): network management, SYNC,
/// heartbeat, emergency. All numbers are little endian (7.1.4). Decoders give nothing for frames
/// that are none of theirs: wrong id, size or kind, or a value that the standard does not know.
namespace tactus {

/// Ids of the generic pre-defined connection set (7.3.5); those of a node have its id added.
namespace cob_id {
inline constexpr std::uint32_t kNmt = 0x000;
inline constexpr std::uint32_t kSync = 0x080;
inline constexpr std::uint32_t kEmergency = 0x080;
inline constexpr std::uint32_t kTpdo1 = 0x180;      ///< from the node
inline constexpr std::uint32_t kRpdo1 = 0x200;      ///< to the node
inline constexpr std::uint32_t kSdoAnswer = 0x580;  ///< from the node
inline constexpr std::uint32_t kSdoRequest = 0x600;
inline constexpr std::uint32_t kHeartbeat = 0x700;
}  // namespace cob_id

inline constexpr int kMaxNodeId = 127;

/// A classic data frame with an 11-bit id, this one, and this many bytes.
bool isDataFrame(const CanFrame& frame, std::uint32_t id, std::uint8_t size) noexcept;

/// The number of `size` bytes (1..4) at `offset`; offset + size <= 8.
std::uint32_t readLittleEndian(const CanFrame& frame, int offset, int size) noexcept;
void writeLittleEndian(CanFrame& frame, int offset, int size, std::uint32_t value) noexcept;

/// Commands of node control (7.2.8.2.1).
enum class NmtCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kEnterPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130,
};

struct NmtMessage {
  NmtCommand command = NmtCommand::kStart;
  int node_id = 0;  ///< 0: all nodes

  bool operator==(const NmtMessage&) const = default;
};

CanFrame nmtFrame(const NmtMessage& message) noexcept;
std::optional<NmtMessage> decodeNmt(const CanFrame& frame) noexcept;

/// SYNC without counter (7.2.5.3.1).
CanFrame syncFrame() noexcept;

/// States as in a heartbeat or boot-up message (7.2.8.3.2, 7.2.8.3.3).
enum class NmtState : std::uint8_t {
  kBootUp = 0,
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 127,
};

CanFrame heartbeatFrame(int node_id, NmtState state) noexcept;
std::optional<NmtState> decodeHeartbeat(const CanFrame& frame, int node_id) noexcept;

/// Emergency (7.2.7): error code 0x0000 says that an error has gone. The five bytes of the
/// manufacturer's are left out.
struct Emergency {
  std::uint16_t code = 0;
  std::uint8_t error_register = 0;  ///< object 1001

  bool operator==(const Emergency&) const = default;
};

CanFrame emergencyFrame(int node_id, const Emergency& emergency) noexcept;
std::optional<Emergency> decodeEmergency(const CanFrame& frame, int node_id) noexcept;

}  // namespace tactus
