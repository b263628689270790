#include "tactus/plant/object_rules.h"

namespace tactus {
namespace {

constexpr std::uint32_t kInvalidBit = 1U << 31;
constexpr std::uint32_t kExtendedBit = 1U << 29;
constexpr std::uint32_t kIdBits = 0x3FFF'FFFF;

AbortCode allowed(bool is_allowed, AbortCode otherwise) {
  return is_allowed ? AbortCode::kNone : otherwise;
}

bool isValid(const ObjectDictionary& objects, std::uint16_t communication_index) {
  return (objects.get(communication_index, 1) & kInvalidBit) == 0;
}

/// Ids that NMT, SYNC, EMCY, SDO and heartbeat need for themselves.
bool isRestricted(std::uint32_t id) {
  return id <= 0x7F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) ||
         (id >= 0x601 && id <= 0x67F) || id >= 0x6E0;
}

AbortCode checkCobId(const ObjectDictionary& objects, std::uint16_t index, std::uint32_t value) {
  if ((value & kExtendedBit) != 0) return AbortCode::kValueRange;
  if ((value & kInvalidBit) != 0) return AbortCode::kNone;
  const bool is_changed = ((value ^ objects.get(index, 1)) & kIdBits) != 0;
  if (isValid(objects, index) && is_changed) return AbortCode::kDeviceState;
  return allowed(!isRestricted(value & kIdBits), AbortCode::kValueRange);
}

AbortCode checkCommunication(const ObjectDictionary& objects, const ObjectDescription& object,
                             std::uint32_t value) {
  if (object.subindex == 1) return checkCobId(objects, object.index, value);
  if (object.subindex == 5) return AbortCode::kNone;
  return allowed(value <= 240 || value >= 254, AbortCode::kValueRange);  // transmission type
}

/// The object that an entry of a mapping (index, subindex, bits) names; nullptr if it may not.
const ObjectDescription* mappedObject(std::uint32_t entry, PdoMapping direction) {
  const ObjectDescription* object = ObjectDictionary::find(static_cast<std::uint16_t>(entry >> 16),
                                                           static_cast<std::uint8_t>(entry >> 8));
  const bool is_right = object != nullptr && object->mapping == direction &&
                        static_cast<int>(entry & 0xFF) == 8 * object->size;
  return is_right ? object : nullptr;
}

AbortCode checkMapping(const ObjectDictionary& objects, const ObjectDescription& object,
                       std::uint32_t value, PdoMapping direction) {
  const auto communication = static_cast<std::uint16_t>(object.index - 0x200);
  if (isValid(objects, communication)) return AbortCode::kDeviceState;
  if (object.subindex != 0) {
    if (objects.get(object.index) != 0) return AbortCode::kUnsupportedAccess;
    return allowed(mappedObject(value, direction) != nullptr, AbortCode::kNotMappable);
  }
  if (value > 8) return AbortCode::kValueRange;
  int bytes = 0;
  for (std::uint32_t i = 1; i <= value; ++i) {
    const std::uint32_t entry = objects.get(object.index, static_cast<std::uint8_t>(i));
    const ObjectDescription* mapped = mappedObject(entry, direction);
    if (mapped == nullptr) return AbortCode::kNotMappable;
    bytes += mapped->size;
  }
  return allowed(bytes <= 8, AbortCode::kMappingTooLong);
}

AbortCode checkRange(const ObjectDescription& object, std::uint32_t value) {
  switch (object.index) {
    case 0x1005:  // no SYNC of its own, 11 bits
      return allowed(value > 0 && value <= 0x7FF, AbortCode::kValueRange);
    case 0x1016:
      return allowed(value >> 24 == 0 && ((value >> 16) & 0xFF) <= 127, AbortCode::kValueRange);
    case 0x605A:
    case 0x605E:
      return allowed(value == 2, AbortCode::kValueRange);
    case 0x6007:
      return allowed(value <= 3, AbortCode::kValueRange);
    case 0x6060:  // none, cyclic synchronous velocity
      return allowed(value == 0 || value == 9, AbortCode::kValueRange);
    case 0x6085:
      return allowed(value > 0, AbortCode::kValueRange);
    case 0x60C2:  // at least 1; 1 us to 1 s
      return allowed(object.subindex == 1 ? value > 0 : value == 0 || value >= 0xFA,
                     AbortCode::kValueRange);
    default:
      return AbortCode::kNone;
  }
}

}  // namespace

AbortCode checkWrite(const ObjectDictionary& objects, const ObjectDescription& object,
                     std::uint32_t value) noexcept {
  const bool is_locked =
      object.index == 0x1005 || (object.index >= 0x1400 && object.index < 0x1C00);
  if (is_locked && objects.isCommunicationLocked()) return AbortCode::kDeviceState;
  switch (object.index) {
    case 0x1400:
    case 0x1800:
      return checkCommunication(objects, object, value);
    case 0x1600:
      return checkMapping(objects, object, value, PdoMapping::kReceived);
    case 0x1A00:
      return checkMapping(objects, object, value, PdoMapping::kTransmitted);
    default:
      return checkRange(object, value);
  }
}

}  // namespace tactus
