#include "tactus/canopen/sdo_client.h"

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/sdo_abort.h"

namespace tactus {
namespace {

/// Command specifiers, the upper three bits of byte 0 (CiA 301, 7.2.4.3).
constexpr std::uint8_t kDownloadRequest = 1 << 5;
constexpr std::uint8_t kUploadRequest = 2 << 5;
constexpr std::uint8_t kUploadAnswer = 2 << 5;
constexpr std::uint8_t kDownloadAnswer = 3 << 5;
constexpr std::uint8_t kAbort = 4 << 5;
constexpr std::uint8_t kSpecifierMask = 7 << 5;

/// Bits of an initiate message: the data is in it; its length is in bits 2 and 3, as 4 - length.
constexpr std::uint8_t kExpedited = 2;
constexpr std::uint8_t kSizeIndicated = 1;

int indicatedSize(std::uint8_t command) noexcept { return 4 - ((command >> 2) & 3); }

bool isOf(const CanFrame& frame, const ObjectEntry& entry) noexcept {
  return readLittleEndian(frame, 1, 2) == entry.index && frame.data[3] == entry.subindex;
}

}  // namespace

SdoClient::SdoClient(int node_id, int timeout_cycles) noexcept
    : node_id_(node_id), timeout_cycles_(timeout_cycles) {}

void SdoClient::begin(const ObjectEntry& entry) noexcept {
  entry_ = entry;
  status_ = SdoStatus::kBusy;
  abort_code_ = 0;
  waited_cycles_ = 0;
  has_pending_ = true;
}

void SdoClient::download(const ObjectEntry& entry, std::uint32_t value) noexcept {
  begin(entry);
  is_upload_ = false;
  const int unused_bytes = 4 - entry.size;
  pending_ = frameFor(
      static_cast<std::uint8_t>(kDownloadRequest | unused_bytes << 2 | kExpedited | kSizeIndicated),
      0);
  writeLittleEndian(pending_, 4, entry.size, value);
}

void SdoClient::upload(const ObjectEntry& entry) noexcept {
  begin(entry);
  is_upload_ = true;
  pending_ = frameFor(kUploadRequest, 0);
}

void SdoClient::receive(const CanFrame& frame) noexcept {
  const auto id = cob_id::kSdoAnswer + static_cast<std::uint32_t>(node_id_);
  const bool is_asked_for = status_ == SdoStatus::kBusy && !has_pending_;
  if (!is_asked_for || !isDataFrame(frame, id, 8)) return;
  const auto specifier = static_cast<std::uint8_t>(frame.data[0] & kSpecifierMask);
  const bool is_initiate = specifier == kUploadAnswer || specifier == kDownloadAnswer;
  if (specifier != kAbort && !is_initiate) return refuse(sdo_abort::kCommandUnknown);
  if (!isOf(frame, entry_)) return;  // late, of an earlier transfer
  if (specifier == kAbort) return receiveAbort(frame);
  // Late, too, where one entry is read and written in turn.
  if (specifier != (is_upload_ ? kUploadAnswer : kDownloadAnswer)) return;
  if (is_upload_) return receiveUpload(frame);
  status_ = SdoStatus::kDone;
}

void SdoClient::receiveAbort(const CanFrame& frame) noexcept {
  abort_code_ = readLittleEndian(frame, 4, 4);
  status_ = SdoStatus::kAborted;
}

void SdoClient::receiveUpload(const CanFrame& frame) noexcept {
  const std::uint8_t command = frame.data[0];
  if ((command & kExpedited) == 0) return refuse(sdo_abort::kLengthMismatch);  // segmented
  const int size = (command & kSizeIndicated) != 0 ? indicatedSize(command) : entry_.size;
  if (size > entry_.size) return refuse(sdo_abort::kTooLong);
  if (size < entry_.size) return refuse(sdo_abort::kTooShort);
  value_ = readLittleEndian(frame, 4, size);
  status_ = SdoStatus::kDone;
}

void SdoClient::refuse(std::uint32_t abort_code) noexcept {
  pending_ = frameFor(kAbort, abort_code);
  has_pending_ = true;
  abort_code_ = abort_code;
  status_ = SdoStatus::kAborted;
}

void SdoClient::update(FrameBatch& out) noexcept {
  if (status_ == SdoStatus::kBusy && waited_cycles_++ >= timeout_cycles_) {
    refuse(sdo_abort::kTimedOut);
    status_ = SdoStatus::kTimedOut;
  }
  if (has_pending_) out.push(pending_);
  has_pending_ = false;
}

CanFrame SdoClient::frameFor(std::uint8_t command, std::uint32_t data) const noexcept {
  CanFrame frame;
  frame.id = cob_id::kSdoRequest + static_cast<std::uint32_t>(node_id_);
  frame.size = 8;
  frame.data[0] = command;
  writeLittleEndian(frame, 1, 2, entry_.index);
  frame.data[3] = entry_.subindex;
  writeLittleEndian(frame, 4, 4, data);
  return frame;
}

}  // namespace tactus
