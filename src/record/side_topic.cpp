#include "tactus/record/side_topic.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/record/ulog_format.h"
#include "tactus/record/ulog_topic.h"
#include "tactus/scene/gain_keys.h"

namespace tactus {
namespace {

struct SideField {
  std::string_view type;
  std::string name;
  std::size_t entries, offset;
};

std::vector<SideField> gainFields() {
  std::vector<SideField> fields;
  for (const GainKey& key : gainKeys())
    fields.push_back({"double", gainFieldName(key.path), 1, key.offset});
  return fields;
}

std::vector<SideField> motionFields() {
  using Plan = ToolMotionPlan;
  return {{"uint64_t", "number", 1, offsetof(Plan, number)},
          {"uint64_t", "kind", 1, offsetof(Plan, kind)},
          {"double", "start_s", 1, offsetof(Plan, start_s)},
          {"double", "from", 18, offsetof(Plan, from)},
          {"double", "target", 6, offsetof(Plan, target)},
          {"double", "R_BaseZero", 9, offsetof(Plan, R_BaseZero)},
          {"double", "limits", 6, offsetof(Plan, limits)}};
}

std::vector<SideField> fieldsOf(const SideTopic& topic) {
  return topic.is_of_commands ? motionFields() : gainFields();
}

}  // namespace

const std::array<SideTopic, kSideTopics>& sideTopics() noexcept {
  static constexpr std::array<SideTopic, kSideTopics> kTopics = {
      SideTopic{kGainsTopic, "gains", offsetof(CycleRecord, gains), sizeof(Gains)},
      SideTopic{kToolMotionTopic, "motion", offsetof(CycleRecord, tool_motion),
                sizeof(ToolMotionPlan), true}};
  return kTopics;
}

std::string gainFieldName(std::string_view path) {
  std::string name(path);
  std::ranges::replace(name, '.', '_');
  return name;
}

std::string sideFormat(const SideTopic& topic) {
  std::string format = fmt::format("{}:uint64_t timestamp;", topic.name);
  for (const SideField& field : fieldsOf(topic)) {
    format += field.type;
    if (field.entries > 1) format += fmt::format("[{}]", field.entries);
    format += fmt::format(" {};", field.name);
  }
  return format;
}

std::string parseSideFormat(const SideTopic& topic, std::string_view format, SideLayout& layout) {
  std::vector<LoggedField> logged;
  layout = {};
  const std::string problem = parseFields(format, logged, layout.size);
  if (!problem.empty()) return problem;
  for (const SideField& field : fieldsOf(topic)) {
    const LoggedField* found = findField(logged, field.name);
    if (!found) continue;
    if (found->type != field.type || found->entries != field.entries)
      return fmt::format("{} of {} is of type {}[{}], {}[{}] is expected", field.name, topic.what,
                         found->type, found->entries, field.type, field.entries);
    appendRun({field.offset, found->offset, field.entries * sizeof(double)}, layout.runs);
  }
  return {};
}

}  // namespace tactus
