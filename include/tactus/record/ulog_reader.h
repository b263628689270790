#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "tactus/record/ulog_definitions.h"
#include "tactus/record/ulog_messages.h"

namespace tactus {

/// Reads the logs of UlogWriter, finding every value by its name in the log's own format. A log is
/// never trusted: whatever is wrong with it ends in an InputError `file:1:<byte>: ...`. Only a log
/// that was cut off behind its definitions is read, up to the cut.
class UlogReader {
 public:
  /// Reads up to the first cycle. `name` is what errors call the file; `in` has to outlive this.
  UlogReader(std::istream& in, std::string name);

  const LogDescription& description() const noexcept { return definitions_.description; }

  /// Whether the log has a field of recordFields(): one of an older version may not.
  bool has(std::string_view field) const noexcept;

  /// What the gains are as far as the log does not say: those of its scene.
  void assumeGains(const Gains& gains) noexcept { sides_.gains = gains; }

  /// False at the end of the log. Entries of arrays beyond the shape, and fields that the log does
  /// not have, keep what they held.
  bool next(CycleRecord& record);

  /// Whether the log ended within a message; known once next() has returned false.
  bool cutOff() const noexcept { return messages_.cutOff(); }

 private:
  /// Takes over what is of a side topic; true for a cycle.
  bool take(const UlogMessage& message, CycleRecord& record);
  void checkSize(const UlogMessage& message, const char* what, std::size_t fields_size) const;

  UlogMessages messages_;
  UlogDefinitions definitions_;
  CycleRecord sides_;                         ///< of which the parts of side topics count
  std::array<bool, kSideTopics> is_known_{};  ///< the log has said what they are
};

/// Opens a log for reading; throws InputError.
std::ifstream openLog(const std::string& path);

struct LogExtent {
  long long cycles = 0;
  bool cut_off = false;  ///< ends within a message: an interrupted run
};

/// Reads what is left of a log. Throws InputError if it is damaged.
LogExtent readToEnd(UlogReader& reader);

/// Throws the InputError of a log without a cycle.
[[noreturn]] void refuseEmptyLog(const std::string& path);

/// Reads a log to its end, so that a damaged one is refused before anything else happens. Throws
/// InputError, also for a log without a cycle.
LogExtent checkLog(const std::string& path);

}  // namespace tactus
