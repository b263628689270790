#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/record/record_fields.h"

namespace tactus {

/// Where a log's data messages hold the fields of a CycleRecord.
struct TopicLayout {
  RecordShape shape;
  std::vector<CopyRun> runs;             ///< message offsets count from the first field
  std::size_t size = 0;                  ///< of all fields, bytes
  std::vector<std::string_view> absent;  ///< of recordFields(), from a log of an older version
};

/// A field of a format message.
struct LoggedField {
  std::string_view type, name;
  std::size_t entries, offset;
};

/// "cycle" of "cycle:uint64_t timestamp;..."; empty if there is no colon.
std::string_view topicName(std::string_view format) noexcept;

/// Reads the text of a format message. Fields that a CycleRecord does not know are passed over.
/// Returns an empty string, or what is wrong with the format and what is expected.
std::string parseTopicFormat(std::string_view format, TopicLayout& layout);

/// The fields of a format message, and the size of all; returns as above.
std::string parseFields(std::string_view format, std::vector<LoggedField>& fields,
                        std::size_t& size);

/// Null: there is none.
const LoggedField* findField(const std::vector<LoggedField>& fields,
                             std::string_view name) noexcept;

}  // namespace tactus
