#include "tactus/record/ulog_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "tactus/record/ulog_format.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

/// Of a disk: where it has lost what was written, the lost part begins with one.
constexpr std::uint64_t kSector_bytes = 512;

bool isZeros(std::string_view bytes) {
  return std::ranges::all_of(bytes, [](char byte) { return byte == 0; });
}

}  // namespace

UlogMessages::UlogMessages(std::istream& in, std::string name)
    : in_(in), name_(std::move(name)), buffer_(kMaxMessageSize) {
  std::array<char, kUlogHeaderSize> header;
  const std::size_t size = read(header.data(), header.size());
  if (size == 0)
    fail(0, "header",
         "is empty: whatever wrote it was killed at once, a log of tactus is expected");
  if (size < header.size() ||
      std::memcmp(header.data(), kUlogMagic.data(), kUlogMagic.size()) != 0) {
    fail(0, "header", "not a ULog file of version 1, a log of tactus is expected");
  }
}

bool UlogMessages::next(UlogMessage& message) {
  if (!std::exchange(has_header_, false)) readHeader();
  message.offset = offset_ - header_size_;
  message.type = 0;
  cut_off_ = header_size_ > 0 && header_size_ < header_.size();
  if (header_size_ < header_.size()) return false;
  if (header_[2] == 0) {
    requireZeros(message.offset);
    cut_off_ = true;
    return false;
  }
  std::uint16_t size = 0;
  std::memcpy(&size, header_.data(), sizeof(size));
  message.type = header_[2];
  message.payload = {buffer_.data(), size};
  cut_off_ = read(buffer_.data(), size) < size;
  if (cut_off_) return false;
  cut_off_ = endsInLostZeros(message);
  if (cut_off_) message.type = 0;
  return !cut_off_;
}

void UlogMessages::readHeader() { header_size_ = read(header_.data(), header_.size()); }

/// Whether the zeros of a lost part begin in this message. For that the next header is read ahead,
/// as zeros may end a whole one, too.
bool UlogMessages::endsInLostZeros(const UlogMessage& message) {
  const std::uint64_t in_last_sector = (offset_ - 1) % kSector_bytes + 1;
  const std::string_view payload = message.payload;
  if (in_last_sector > payload.size()) return false;
  if (!isZeros(payload.substr(payload.size() - in_last_sector))) return false;
  readHeader();
  has_header_ = true;
  if (header_size_ == 0 || !isZeros({header_.data(), header_size_})) return false;
  requireZeros(offset_ - header_size_);
  return true;
}

/// Nothing that is written has no type. What a loss of power took is zeros to the end of the file;
/// anything else is damage.
void UlogMessages::requireZeros(std::uint64_t offset) {
  int byte = 0;
  while ((byte = in_.get()) == 0) ++offset_;
  if (in_.bad()) failToRead();
  if (byte != std::istream::traits_type::eof())
    fail(offset, "message", "unknown type 0x00, an undamaged log is expected");
}

void UlogMessages::checkIgnorable(const UlogMessage& message) const {
  if (std::string_view("FIMPQADRLCSO").find(message.type) == std::string_view::npos) {
    fail(message.offset, "message",
         fmt::format("unknown type {:#04x}, an undamaged log is expected",
                     static_cast<unsigned char>(message.type)));
  }
}

void UlogMessages::fail(std::uint64_t offset, std::string_view key,
                        std::string_view complaint) const {
  throw InputError(
      fmt::format("{}:1:{}: {}: {}", escaped(name_), offset + 1, key, escaped(complaint)));
}

void UlogMessages::failToRead() const {
  fail(offset_, "file", "cannot be read, a readable file is expected");
}

std::size_t UlogMessages::read(char* bytes, std::size_t size) {
  in_.read(bytes, static_cast<std::streamsize>(size));
  if (in_.bad()) failToRead();
  const auto count = static_cast<std::size_t>(in_.gcount());
  offset_ += count;
  return count;
}

}  // namespace tactus
