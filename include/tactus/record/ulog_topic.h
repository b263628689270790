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

/// Where a log's data messages hold the gains.
struct GainsLayout {
  std::vector<CopyRun> runs;  ///< from Gains, in place of a record
  std::size_t size = 0;       ///< of all fields, bytes
};

/// The field of a gain: "controller_damping" of "controller.damping".
std::string gainFieldName(std::string_view path);

/// "cycle" of "cycle:uint64_t timestamp;..."; empty if there is no colon.
std::string_view topicName(std::string_view format) noexcept;

/// Reads the text of a format message. Fields that a CycleRecord does not know are passed over.
/// Returns an empty string, or what is wrong with the format and what is expected.
std::string parseTopicFormat(std::string_view format, TopicLayout& layout);

/// Likewise of the gains. A gain that the log does not know has no run.
std::string parseGainsFormat(std::string_view format, GainsLayout& layout);

}  // namespace tactus
