#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/record/record_fields.h"

namespace tactus {

/// A part of each record that a log holds in a topic of its own: before the first cycle of a file,
/// and where it has changed.
struct SideTopic {
  const char* name;
  const char* what;             ///< for people
  std::size_t offset, size;     ///< in a CycleRecord, bytes
  bool is_of_commands = false;  ///< only tasks by command have it
};

inline constexpr int kSideTopics = 2;
const std::array<SideTopic, kSideTopics>& sideTopics() noexcept;

/// Where a log's data messages hold such a part.
struct SideLayout {
  std::vector<CopyRun> runs;  ///< from the start of the record's part
  std::size_t size = 0;       ///< of all fields, bytes
};

/// The field of a gain: "controller_damping" of "controller.damping".
std::string gainFieldName(std::string_view path);

/// "name:uint64_t timestamp;..."
std::string sideFormat(const SideTopic& topic);

/// Reads the text of a format message. Fields that the part does not know are passed over, those
/// that the log does not know have no run. Returns an empty string, or what is wrong and what is
/// expected.
std::string parseSideFormat(const SideTopic& topic, std::string_view format, SideLayout& layout);

}  // namespace tactus
