#include "tactus/record/ulog_topic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "tactus/record/ulog_format.h"

namespace tactus {
namespace {

constexpr std::array<std::pair<std::string_view, std::size_t>, 12> kTypeSizes = {{
    {"int8_t", 1},
    {"uint8_t", 1},
    {"int16_t", 2},
    {"uint16_t", 2},
    {"int32_t", 4},
    {"uint32_t", 4},
    {"int64_t", 8},
    {"uint64_t", 8},
    {"float", 4},
    {"double", 8},
    {"bool", 1},
    {"char", 1},
}};

std::size_t typeSize(std::string_view type) noexcept {
  for (const auto& [name, size] : kTypeSizes) {
    if (name == type) return size;
  }
  return 0;
}

/// "double[9] q" or "double t_s"; false if it is neither.
bool parseField(std::string_view text, LoggedField& field) noexcept {
  const std::size_t space = text.find(' ');
  if (space == std::string_view::npos || space + 1 == text.size()) return false;
  field.type = text.substr(0, space);
  field.name = text.substr(space + 1);
  field.entries = 1;
  const std::size_t bracket = field.type.find('[');
  if (bracket == std::string_view::npos) return true;
  if (bracket + 1 == field.type.size()) return false;
  const char* const end = field.type.data() + field.type.size() - 1;
  const auto [next, error] = std::from_chars(field.type.data() + bracket + 1, end, field.entries);
  if (error != std::errc() || next != end || *end != ']') return false;
  field.type = field.type.substr(0, bracket);
  return field.entries >= 1 && field.entries <= kMaxMessageSize;
}

std::string findShape(const std::vector<LoggedField>& fields, RecordShape& shape) {
  const LoggedField* q = findField(fields, "q");
  const LoggedField* w = findField(fields, "w");
  if (!q || q->entries < 2 || q->entries > kMaxJoints) {
    return fmt::format("no field q with an entry for each joint, 2 to {} are expected", kMaxJoints);
  }
  if (!w || w->entries > kMaxTaskSize) {
    return fmt::format("no field w with an entry for each task component, 1 to {} are expected",
                       kMaxTaskSize);
  }
  const LoggedField* force = findField(fields, "force_sensor_N");
  if (!force || force->entries > kMaxTactileModules) {
    return fmt::format(
        "no field force_sensor_N with an entry for each tactile module, 1 to {} are expected",
        kMaxTactileModules);
  }
  shape = {static_cast<int>(q->entries),
           static_cast<int>(w->entries),
           findField(fields, "tool_rotation_error_rad") != nullptr,
           static_cast<int>(force->entries),
           findField(fields, "tactile_moment_x_Nm") != nullptr,
           findField(fields, "modules_lost") != nullptr};
  return {};
}

}  // namespace

std::string_view topicName(std::string_view format) noexcept {
  const std::size_t colon = format.find(':');
  return format.substr(0, colon == std::string_view::npos ? 0 : colon);
}

std::string parseFields(std::string_view format, std::vector<LoggedField>& fields,
                        std::size_t& size) {
  std::string_view text = format.substr(topicName(format).size() + 1);
  while (!text.empty()) {
    const std::size_t end = text.find(';');
    const std::string_view field_text = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    LoggedField field;
    if (!parseField(field_text, field) || typeSize(field.type) == 0) {
      return fmt::format("\"{}\" is no field, a basic type and a name are expected", field_text);
    }
    field.offset = size;
    size += field.entries * typeSize(field.type);
    if (size > kMaxMessageSize - sizeof(std::uint16_t)) {
      return "fields larger than a message, at most 65533 bytes are expected";
    }
    fields.push_back(field);
  }
  return {};
}

const LoggedField* findField(const std::vector<LoggedField>& fields,
                             std::string_view name) noexcept {
  for (const LoggedField& field : fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

std::string parseTopicFormat(std::string_view format, TopicLayout& layout) {
  std::vector<LoggedField> logged;
  layout = {};
  std::string problem = parseFields(format, logged, layout.size);
  if (problem.empty()) problem = findShape(logged, layout.shape);
  if (!problem.empty()) return problem;
  for (const RecordField& field : recordFields()) {
    const LoggedField* found = findField(logged, field.name);
    if (!found && field.may_be_absent) {
      layout.absent.push_back(field.name);
      continue;
    }
    const std::size_t entries = layout.shape.entries(field);
    if (!found || found->type != typeName(field.type) || found->entries != entries) {
      return fmt::format("no field {} of type {}[{}], every field of a cycle is expected",
                         field.name, typeName(field.type), entries);
    }
    appendRun({field.offset, found->offset, entries * sizeof(double)}, layout.runs);
  }
  return {};
}

}  // namespace tactus
