#pragma once

#include <array>
#include <cstdint>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/record/ulog_format.h"

namespace tactus {

/// One message of a ULog file; the payload lives until the next one is read.
struct UlogMessage {
  char type = 0;
  std::string_view payload;
  std::uint64_t offset = 0;  ///< of the message's header in the file, bytes
};

/// Splits a ULog file, which nobody has checked, into messages. Needs 64 KiB whatever the file
/// claims about itself.
class UlogMessages {
 public:
  /// Checks magic and version. `name` is what errors call the file; `in` has to outlive this.
  /// Throws InputError.
  UlogMessages(std::istream& in, std::string name);

  /// False at the end of the file, also where it ends within a message: then type and size of that
  /// one are there if its header is, and else its type is 0, as where nothing but zeros is left,
  /// which a loss of power leaves behind. Throws InputError if the file cannot be read.
  bool next(UlogMessage& message);

  /// Throws InputError for a message of a type that the format does not know: there the file is
  /// damaged and everything behind would be misread.
  void checkIgnorable(const UlogMessage& message) const;

  /// Whether the file ended within a message: an interrupted run.
  bool cutOff() const noexcept { return cut_off_; }

  /// Bytes read so far.
  std::uint64_t offset() const noexcept { return offset_; }

  /// Throws InputError `name:1:<offset + 1>: key: complaint`.
  [[noreturn]] void fail(std::uint64_t offset, std::string_view key,
                         std::string_view complaint) const;

 private:
  void readHeader();
  bool endsInLostZeros(const UlogMessage& message);
  void requireZeros(std::uint64_t offset);
  [[noreturn]] void failToRead() const;
  std::size_t read(char* bytes, std::size_t size);

  std::istream& in_;
  std::string name_;
  std::vector<char> buffer_;
  std::array<char, kMessageHeaderSize> header_{};
  std::size_t header_size_ = 0;  ///< how much of it the file had
  bool has_header_ = false;      ///< that of the next message has been read already
  std::uint64_t offset_ = 0;
  bool cut_off_ = false;
};

}  // namespace tactus
