#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "tactus/canopen/hardware_config.h"

namespace tactus {

/// SDO abort codes of CiA 301.
enum class AbortCode : std::uint32_t {
  kNone = 0,
  kUnknownCommand = 0x0504'0001,
  kUnsupportedAccess = 0x0601'0000,
  kReadOnly = 0x0601'0002,
  kNoObject = 0x0602'0000,
  kNotMappable = 0x0604'0041,
  kMappingTooLong = 0x0604'0042,
  kTooLong = 0x0607'0012,
  kTooShort = 0x0607'0013,
  kNoSubindex = 0x0609'0011,
  kValueRange = 0x0609'0030,
  kDeviceState = 0x0800'0022,
};

enum class ObjectAccess : std::uint8_t { kReadOnly, kWritable };
enum class PdoMapping : std::uint8_t { kNever, kReceived, kTransmitted };

struct ObjectDescription {
  std::uint16_t index;
  std::uint8_t subindex;
  std::uint8_t size;  ///< bytes, 1, 2 or 4
  ObjectAccess access;
  PdoMapping mapping;
  std::uint32_t initial;  ///< the node id comes on top in 1014, 1400:01 and 1800:01
};

/// A drive's objects (CiA 301 and 402), with the values a factory leaves: PDOs carry control and
/// status word only, and are not synchronous. Numbers are kept as they are on the bus, in the low
/// bytes.
class ObjectDictionary {
 public:
  /// identity: what 1018 tells in place of a factory's.
  explicit ObjectDictionary(int node_id, const DriveConfig& identity = {});

  /// The initial values of all objects from first_index to last_index.
  void reset(std::uint16_t first_index, std::uint16_t last_index) noexcept;

  /// Nullptr if there is none.
  static const ObjectDescription* find(std::uint16_t index, std::uint8_t subindex) noexcept;
  static bool hasIndex(std::uint16_t index) noexcept;

  /// Of an object that exists; of others 0.
  std::uint32_t get(std::uint16_t index, std::uint8_t subindex = 0) const noexcept;
  std::int32_t getSigned(std::uint16_t index, std::uint8_t subindex = 0) const noexcept;
  void set(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) noexcept;

  /// As an SDO client writes: refused unless object, size and value are right.
  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::uint32_t value,
                  int size) noexcept;

  /// While the node is operational many drives let nobody change SYNC and PDOs.
  void lockCommunication(bool is_locked) noexcept { is_communication_locked_ = is_locked; }
  bool isCommunicationLocked() const noexcept { return is_communication_locked_; }

 private:
  std::uint32_t initialValue(const ObjectDescription& object) const noexcept;

  int node_id_;
  bool is_communication_locked_ = false;
  std::optional<std::uint32_t> vendor_id_, product_code_;
  std::array<std::uint32_t, 64> values_{};
};

}  // namespace tactus
