#include "tactus/plant/sdo_server.h"

namespace tactus {
namespace {

constexpr int kDownloadRequest = 1;  // client command specifiers
constexpr int kUploadRequest = 2;
constexpr int kAbort = 4;

/// Little-endian, as every number of CANopen.
void put32(CanFrame& frame, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) frame.data[4 + i] = static_cast<std::uint8_t>(value >> 8 * i);
}

std::uint32_t get32(const CanFrame& frame, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= std::uint32_t{frame.data[4 + i]} << 8 * i;
  return value;
}

AbortCode upload(const ObjectDictionary& objects, std::uint16_t index, std::uint8_t subindex,
                 CanFrame& response) {
  const ObjectDescription* object = ObjectDictionary::find(index, subindex);
  if (object == nullptr)
    return ObjectDictionary::hasIndex(index) ? AbortCode::kNoSubindex : AbortCode::kNoObject;
  response.data[0] = static_cast<std::uint8_t>(0x43 | (4 - object->size) << 2);
  put32(response, objects.get(index, subindex));
  return AbortCode::kNone;
}

AbortCode download(const CanFrame& request, ObjectDictionary& objects, std::uint16_t index,
                   std::uint8_t subindex, CanFrame& response) {
  const bool is_expedited = (request.data[0] & 2) != 0;
  const bool names_size = (request.data[0] & 1) != 0;
  if (!is_expedited) return AbortCode::kUnknownCommand;
  const ObjectDescription* object = ObjectDictionary::find(index, subindex);
  int size = object == nullptr ? 4 : object->size;
  if (names_size) size = 4 - ((request.data[0] >> 2) & 3);
  response.data[0] = 0x60;
  return objects.write(index, subindex, get32(request, size), size);
}

}  // namespace

bool answerSdo(const CanFrame& request, ObjectDictionary& objects, CanFrame& response) noexcept {
  const int command = request.data[0] >> 5;
  if (request.size != 8 || command == kAbort) return false;
  const auto index = static_cast<std::uint16_t>(request.data[1] | request.data[2] << 8);
  const std::uint8_t subindex = request.data[3];
  response.size = 8;
  response.data = {0, request.data[1], request.data[2], subindex, 0, 0, 0, 0};
  AbortCode problem = AbortCode::kUnknownCommand;
  if (command == kDownloadRequest) problem = download(request, objects, index, subindex, response);
  if (command == kUploadRequest) problem = upload(objects, index, subindex, response);
  if (problem == AbortCode::kNone) return true;
  response.data[0] = 0x80;
  put32(response, static_cast<std::uint32_t>(problem));
  return true;
}

}  // namespace tactus
