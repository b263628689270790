#pragma once

#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"
#include "tactus/plant/object_dictionary.h"

namespace tactus {

/// A PDO of the dictionary: 1400 and 1600, or 1800 and 1A00.
struct PdoObjects {
  std::uint16_t communication;
  std::uint16_t mapping;
};
inline constexpr PdoObjects kReceivePdo{0x1400, 0x1600};
inline constexpr PdoObjects kTransmitPdo{0x1800, 0x1A00};

/// The PDO's id; absent while it is not valid.
std::optional<std::uint32_t> pdoId(const ObjectDictionary& objects, PdoObjects pdo) noexcept;
int pdoBytes(const ObjectDictionary& objects, PdoObjects pdo) noexcept;

/// Writes what an RPDO carries. A value out of an object's range leaves that object alone.
void unpackRpdo(const CanFrame& frame, ObjectDictionary& objects) noexcept;
/// Fills size and data from the mapping.
void packTpdo(const ObjectDictionary& objects, CanFrame& frame) noexcept;

}  // namespace tactus
