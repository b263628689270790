#include "tactus/plant/object_dictionary.h"

#include <algorithm>
#include <cstddef>

#include "tactus/plant/object_rules.h"

namespace tactus {
namespace {

constexpr auto kRo = ObjectAccess::kReadOnly;
constexpr auto kRw = ObjectAccess::kWritable;
constexpr auto kNever = PdoMapping::kNever;
constexpr auto kReceived = PdoMapping::kReceived;
constexpr auto kTransmitted = PdoMapping::kTransmitted;

// In order.
constexpr auto kObjects = std::to_array<ObjectDescription>({
    {0x1000, 0, 4, kRo, kNever, 0x0002'0192},  // device type: servo drive, profile 402
    {0x1001, 0, 1, kRo, kTransmitted, 0},      // error register
    {0x1005, 0, 4, kRw, kNever, 0x80},         // COB-id of SYNC
    {0x1014, 0, 4, kRo, kNever, 0x80},         // COB-id of EMCY
    {0x1016, 0, 1, kRo, kNever, 1},            // consumed heartbeats
    {0x1016, 1, 4, kRw, kNever, 0},            // node << 16 | ms
    {0x1017, 0, 2, kRw, kNever, 0},            // produced heartbeat, ms
    {0x1018, 0, 1, kRo, kNever, 4},            // identity
    {0x1018, 1, 4, kRo, kNever, 0x7ac},        // vendor
    {0x1018, 2, 4, kRo, kNever, 1},            // product
    {0x1018, 3, 4, kRo, kNever, 0x0001'0000},  // revision
    {0x1018, 4, 4, kRo, kNever, 1},            // serial number
    {0x1400, 0, 1, kRo, kNever, 5},            // RPDO 1
    {0x1400, 1, 4, kRw, kNever, 0x200},        // COB-id
    {0x1400, 2, 1, kRw, kNever, 255},          // transmission type
    {0x1400, 5, 2, kRw, kNever, 0},            // event timer: its deadline, ms; 0: none
    {0x1600, 0, 1, kRw, kNever, 1},            // its mapping
    {0x1600, 1, 4, kRw, kNever, 0x6040'0010},  //
    {0x1600, 2, 4, kRw, kNever, 0},            //
    {0x1600, 3, 4, kRw, kNever, 0},            //
    {0x1600, 4, 4, kRw, kNever, 0},            //
    {0x1600, 5, 4, kRw, kNever, 0},            //
    {0x1600, 6, 4, kRw, kNever, 0},            //
    {0x1600, 7, 4, kRw, kNever, 0},            //
    {0x1600, 8, 4, kRw, kNever, 0},            //
    {0x1800, 0, 1, kRo, kNever, 2},            // TPDO 1
    {0x1800, 1, 4, kRw, kNever, 0x180},        // COB-id
    {0x1800, 2, 1, kRw, kNever, 255},          // transmission type
    {0x1A00, 0, 1, kRw, kNever, 1},            // its mapping
    {0x1A00, 1, 4, kRw, kNever, 0x6041'0010},  //
    {0x1A00, 2, 4, kRw, kNever, 0},            //
    {0x1A00, 3, 4, kRw, kNever, 0},            //
    {0x1A00, 4, 4, kRw, kNever, 0},            //
    {0x1A00, 5, 4, kRw, kNever, 0},            //
    {0x1A00, 6, 4, kRw, kNever, 0},            //
    {0x1A00, 7, 4, kRw, kNever, 0},            //
    {0x1A00, 8, 4, kRw, kNever, 0},            //
    {0x6007, 0, 2, kRw, kNever, 0},            // abort connection: goes on unless it is told
    {0x603F, 0, 2, kRo, kTransmitted, 0},      // error code
    {0x6040, 0, 2, kRw, kReceived, 0},         // control word
    {0x6041, 0, 2, kRo, kTransmitted, 0},      // status word
    {0x605A, 0, 2, kRw, kNever, 2},            // quick stop: ramp, then switch on disabled
    {0x605E, 0, 2, kRw, kNever, 2},            // fault reaction: a ramp
    {0x6060, 0, 1, kRw, kReceived, 0},         // mode of operation
    {0x6061, 0, 1, kRo, kTransmitted, 0},      // mode of operation, display
    {0x6064, 0, 4, kRo, kTransmitted, 0},      // position, counts
    {0x606C, 0, 4, kRo, kTransmitted, 0},      // velocity, counts/s
    {0x607F, 0, 4, kRw, kNever, 0xFFFF'FFFF},  // largest speed in the mode, counts/s
    {0x6085, 0, 4, kRw, kNever, 10'000'000},   // quick stop deceleration, counts/s^2
    {0x60B1, 0, 4, kRw, kReceived, 0},         // velocity offset, counts/s
    {0x60B2, 0, 2, kRw, kReceived, 0},         // torque offset: no axis here has torque
    {0x60C2, 0, 1, kRo, kNever, 2},            // interpolation time
    {0x60C2, 1, 1, kRw, kNever, 10},           // value
    {0x60C2, 2, 1, kRw, kNever, 0xFD},         // power of ten, signed: ms
    {0x60FF, 0, 4, kRw, kReceived, 0},         // target velocity, counts/s
    {0x6502, 0, 4, kRo, kNever, 1U << 8},      // modes there are: cyclic synchronous velocity
});
static_assert(kObjects.size() <= 64, "values_ holds them all");

constexpr bool isBefore(const ObjectDescription& a, const ObjectDescription& b) {
  return a.index != b.index ? a.index < b.index : a.subindex < b.subindex;
}
static_assert(std::is_sorted(kObjects.begin(), kObjects.end(), isBefore));

/// Found by hashing: a plant asks for objects a thousand times a cycle, and half of what it took
/// went into bisection.
class Positions {
 public:
  constexpr Positions() {
    positions_.fill(kFree);
    for (std::size_t i = 0; i < kObjects.size(); ++i) {
      std::size_t slot = firstSlot(kObjects[i].index, kObjects[i].subindex);
      while (positions_[slot] != kFree) slot = next(slot);
      positions_[slot] = static_cast<std::uint8_t>(i);
    }
  }

  constexpr const ObjectDescription* find(std::uint16_t index, std::uint8_t subindex) const {
    for (std::size_t slot = firstSlot(index, subindex); positions_[slot] != kFree;
         slot = next(slot)) {
      const ObjectDescription& object = kObjects[positions_[slot]];
      if (object.index == index && object.subindex == subindex) return &object;
    }
    return nullptr;
  }

 private:
  static constexpr std::size_t kSlots = 256;  // most of them free
  static constexpr std::uint8_t kFree = 0xFF;

  static constexpr std::size_t firstSlot(std::uint16_t index, std::uint8_t subindex) {
    return (index ^ index >> 8 ^ subindex << 5) % kSlots;
  }
  static constexpr std::size_t next(std::size_t slot) { return (slot + 1) % kSlots; }

  std::array<std::uint8_t, kSlots> positions_{};
};
constexpr Positions kPositions;

constexpr std::uint32_t mask(const ObjectDescription& object) {
  return object.size == 4 ? 0xFFFF'FFFFU : (1U << 8 * object.size) - 1U;
}

std::ptrdiff_t positionOf(const ObjectDescription* object) { return object - kObjects.data(); }

bool carriesNodeId(const ObjectDescription& object) {
  return object.index == 0x1014 ||
         ((object.index == 0x1400 || object.index == 0x1800) && object.subindex == 1);
}

}  // namespace

ObjectDictionary::ObjectDictionary(int node_id, const DriveConfig& identity)
    : node_id_(node_id), vendor_id_(identity.vendor_id), product_code_(identity.product_code) {
  reset(0, 0xFFFF);
}

void ObjectDictionary::reset(std::uint16_t first_index, std::uint16_t last_index) noexcept {
  for (const ObjectDescription& object : kObjects) {
    if (object.index < first_index || object.index > last_index) continue;
    values_[positionOf(&object)] = initialValue(object);
  }
}

std::uint32_t ObjectDictionary::initialValue(const ObjectDescription& object) const noexcept {
  if (object.index == 0x1018 && object.subindex == 1) return vendor_id_.value_or(object.initial);
  if (object.index == 0x1018 && object.subindex == 2) return product_code_.value_or(object.initial);
  return object.initial + (carriesNodeId(object) ? static_cast<std::uint32_t>(node_id_) : 0);
}

const ObjectDescription* ObjectDictionary::find(std::uint16_t index,
                                                std::uint8_t subindex) noexcept {
  return kPositions.find(index, subindex);
}

bool ObjectDictionary::hasIndex(std::uint16_t index) noexcept { return find(index, 0) != nullptr; }

std::uint32_t ObjectDictionary::get(std::uint16_t index, std::uint8_t subindex) const noexcept {
  const ObjectDescription* object = find(index, subindex);
  return object == nullptr ? 0 : values_[positionOf(object)];
}

std::int32_t ObjectDictionary::getSigned(std::uint16_t index,
                                         std::uint8_t subindex) const noexcept {
  const ObjectDescription* object = find(index, subindex);
  if (object == nullptr) return 0;
  const int unused_bits = 32 - 8 * object->size;
  return static_cast<std::int32_t>(values_[positionOf(object)] << unused_bits) >> unused_bits;
}

void ObjectDictionary::set(std::uint16_t index, std::uint8_t subindex,
                           std::uint32_t value) noexcept {
  const ObjectDescription* object = find(index, subindex);
  if (object != nullptr) values_[positionOf(object)] = value & mask(*object);
}

AbortCode ObjectDictionary::write(std::uint16_t index, std::uint8_t subindex, std::uint32_t value,
                                  int size) noexcept {
  const ObjectDescription* object = find(index, subindex);
  if (object == nullptr) return hasIndex(index) ? AbortCode::kNoSubindex : AbortCode::kNoObject;
  if (object->access == kRo) return AbortCode::kReadOnly;
  if (size > object->size) return AbortCode::kTooLong;
  if (size < object->size) return AbortCode::kTooShort;
  const AbortCode problem = checkWrite(*this, *object, value & mask(*object));
  if (problem == AbortCode::kNone) set(index, subindex, value);
  return problem;
}

}  // namespace tactus
