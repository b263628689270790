#include "tactus/scene/key_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace tactus {
namespace {

std::string describeRange(const Range& range) {
  const bool has_lower = std::isfinite(range.lower);
  const bool has_upper = std::isfinite(range.upper);
  if (!has_lower && !has_upper) return "";
  if (!has_upper) return fmt::format(" {} {}", range.lower_open ? ">" : ">=", range.lower);
  if (range.lower_open) return fmt::format(" > {} and <= {}", range.lower, range.upper);
  return fmt::format(" from {} to {}", range.lower, range.upper);
}

std::string describeCount(const Count& count, const char* noun) {
  if (count.one_a_joint) return fmt::format("one {} a joint", noun);
  if (count.min == count.max) return fmt::format("{} {}s", count.min, noun);
  return fmt::format("{} to {} {}s", count.min, count.max, noun);
}

}  // namespace

const char* contextName(KeyContext context) noexcept {
  switch (context) {
    case KeyContext::kFree:
      return "free";
    case KeyContext::kLive:
      return "live";
    case KeyContext::kRestart:
      break;
  }
  return "restart";
}

std::string describeExpectation(const KeySpec& spec) {
  const std::string unit = spec.unit.empty() ? "" : " in " + spec.unit;
  switch (spec.type) {
    case ValueType::kNumber:
    case ValueType::kInteger:
      return fmt::format("{}{}{}", spec.numberNoun(), describeRange(spec.range), unit);
    case ValueType::kBoolean:
      return "true or false";
    case ValueType::kText:
      return "text";
    case ValueType::kChoice:
      return fmt::format("one of {}", fmt::join(spec.choices, ", "));
    case ValueType::kChoiceList:
      return fmt::format("a list of {} to {} distinct words of {}", spec.count.min, spec.count.max,
                         fmt::join(spec.choices, ", "));
    case ValueType::kNumberList:
      return fmt::format("a list of {}{}{}", describeCount(spec.count, "number"),
                         describeRange(spec.range), unit);
    case ValueType::kNumberTable:
      return fmt::format("a list of {} of {} numbers{}", describeCount(spec.count, "list"),
                         spec.columns, describeRange(spec.range));
    case ValueType::kSection:
      return "a section of keys";
    case ValueType::kSectionList:
      return fmt::format("a list of {}", describeCount(spec.count, "section"));
  }
  return "";
}

std::string keyWithin(const std::vector<KeySpec>& keys, const std::string& name) {
  for (const KeySpec& spec : keys) {
    if (spec.type != ValueType::kSection) continue;
    for (const KeySpec& inner : spec.keys)
      if (inner.key == name) return spec.key + "." + name;
    const std::string path = keyWithin(spec.keys, name);
    if (!path.empty()) return spec.key + "." + path;
  }
  return "";
}

}  // namespace tactus
