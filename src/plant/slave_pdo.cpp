#include "tactus/plant/slave_pdo.h"

namespace tactus {
namespace {

struct MappedObject {
  std::uint16_t index;
  std::uint8_t subindex;
  int bytes;
};

MappedObject mappedObject(const ObjectDictionary& objects, PdoObjects pdo, int i) {
  const std::uint32_t entry = objects.get(pdo.mapping, static_cast<std::uint8_t>(i + 1));
  return {static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8),
          static_cast<int>(entry & 0xFF) / 8};
}

int entries(const ObjectDictionary& objects, PdoObjects pdo) {
  return static_cast<int>(objects.get(pdo.mapping));
}

}  // namespace

std::optional<std::uint32_t> pdoId(const ObjectDictionary& objects, PdoObjects pdo) noexcept {
  const std::uint32_t cob_id = objects.get(pdo.communication, 1);
  if (cob_id >> 31 != 0) return std::nullopt;
  return cob_id & 0x7FF;
}

int pdoBytes(const ObjectDictionary& objects, PdoObjects pdo) noexcept {
  int bytes = 0;
  for (int i = 0; i < entries(objects, pdo); ++i) bytes += mappedObject(objects, pdo, i).bytes;
  return bytes;
}

void unpackRpdo(const CanFrame& frame, ObjectDictionary& objects) noexcept {
  int at = 0;
  for (int i = 0; i < entries(objects, kReceivePdo); ++i) {
    const MappedObject object = mappedObject(objects, kReceivePdo, i);
    std::uint32_t value = 0;
    for (int k = 0; k < object.bytes; ++k) value |= std::uint32_t{frame.data[at++]} << 8 * k;
    objects.write(object.index, object.subindex, value, object.bytes);
  }
}

void packTpdo(const ObjectDictionary& objects, CanFrame& frame) noexcept {
  int at = 0;
  for (int i = 0; i < entries(objects, kTransmitPdo); ++i) {
    const MappedObject object = mappedObject(objects, kTransmitPdo, i);
    const std::uint32_t value = objects.get(object.index, object.subindex);
    for (int k = 0; k < object.bytes; ++k)
      frame.data[at++] = static_cast<std::uint8_t>(value >> 8 * k);
  }
  frame.size = static_cast<std::uint8_t>(at);
}

}  // namespace tactus
