#include "tactus/record/ulog_messages.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "tactus/record/ulog_format.h"
#include "tactus/scene/located_error.h"

namespace tactus {

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
  std::array<char, kMessageHeaderSize> header;
  message.offset = offset_;
  message.type = 0;
  const std::size_t header_size = read(header.data(), header.size());
  cut_off_ = header_size > 0 && header_size < header.size();
  if (header_size < header.size()) return false;
  std::uint16_t size = 0;
  std::memcpy(&size, header.data(), sizeof(size));
  message.type = header[2];
  message.payload = {buffer_.data(), size};
  cut_off_ = read(buffer_.data(), size) < size;
  return !cut_off_;
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

std::size_t UlogMessages::read(char* bytes, std::size_t size) {
  in_.read(bytes, static_cast<std::streamsize>(size));
  if (in_.bad()) fail(offset_, "file", "cannot be read, a readable file is expected");
  const auto count = static_cast<std::size_t>(in_.gcount());
  offset_ += count;
  return count;
}

}  // namespace tactus
