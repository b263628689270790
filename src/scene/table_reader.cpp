#include "tactus/scene/table_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>

#include "tactus/scene/number_text.h"

namespace tactus {
namespace {

using Kind = YamlNode::Kind;

/// One value on its way from a node to the draft.
struct Reading {
  const YamlNode& node;
  const KeySpec& spec;
  std::string path;
  ConfigDraft& draft;

  [[noreturn]] void fail(const YamlNode& at, const std::string& key,
                         const std::string& problem) const {
    failAt(at.at, key, problem, "expected " + describeExpectation(spec));
  }
  [[noreturn]] void failType() const { fail(node, path, describe(node)); }
};

template <class T>
T& target(const Reading& r) {
  return std::get<T& (*)(ConfigDraft&)>(r.spec.target)(r.draft);
}

std::from_chars_result fromChars(std::string_view text, double& value) {
  return std::from_chars(text.data(), text.data() + text.size(), value);
}

/// Whole numbers may be hexadecimal: 0x100.
template <std::integral T>
std::from_chars_result fromChars(std::string_view text, T& value) {
  const bool is_hex = text.starts_with("0x");
  const std::string_view digits = text.substr(is_hex ? 2 : 0);
  if (is_hex && digits.starts_with('-')) return {digits.data(), std::errc::invalid_argument};
  return std::from_chars(digits.data(), text.data() + text.size(), value, is_hex ? 16 : 10);
}

template <class T>
T parseNumber(const Reading& r, const YamlNode& node, const std::string& path) {
  if (node.kind != Kind::kScalar || node.quoted) r.fail(node, path, describe(node));
  T value{};
  const std::string_view text = withoutPlus(node.text);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = fromChars(text, value);
  if (error == std::errc::result_out_of_range) {
    r.fail(node, path, inQuotes(node.text) + " is out of range");
  }
  if (error != std::errc() || stop != end) {
    r.fail(node, path, inQuotes(node.text) + " is not " + r.spec.numberNoun());
  }
  if (!std::isfinite(static_cast<double>(value))) {
    r.fail(node, path, inQuotes(node.text) + " is not finite");
  }
  const Range& range = r.spec.range;
  const double number = static_cast<double>(value);
  if (number < range.lower || number > range.upper || (range.lower_open && number == range.lower)) {
    r.fail(node, path, inQuotes(node.text) + " is out of range");
  }
  r.draft.numbers.emplace_back(path, number);
  return value;
}

std::vector<double> parseNumbers(const Reading& r, const YamlNode& node, const std::string& path,
                                 int min, int max) {
  const int size = static_cast<int>(node.items.size());
  if (node.kind != Kind::kList || size < min || size > max) r.fail(node, path, describe(node));
  std::vector<double> numbers;
  for (int i = 0; i < size; ++i) {
    numbers.push_back(parseNumber<double>(r, node.items[i], fmt::format("{}[{}]", path, i)));
  }
  return numbers;
}

void readInteger(const Reading& r) {
  if (std::holds_alternative<int& (*)(ConfigDraft&)>(r.spec.target)) {
    target<int>(r) = parseNumber<int>(r, r.node, r.path);
  } else {
    target<std::uint64_t>(r) = parseNumber<std::uint64_t>(r, r.node, r.path);
  }
}

void readBoolean(const Reading& r) {
  const bool is_word = r.node.kind == Kind::kScalar && !r.node.quoted;
  if (!is_word || (r.node.text != "true" && r.node.text != "false")) r.failType();
  target<bool>(r) = r.node.text == "true";
}

void readText(const Reading& r) {
  if (r.node.kind != Kind::kScalar || r.node.text.empty()) r.failType();
  target<std::string>(r) = r.node.text;
}

std::string parseChoice(const Reading& r, const YamlNode& node, const std::string& path) {
  const auto& choices = r.spec.choices;
  if (node.kind != Kind::kScalar || std::ranges::count(choices, node.text) == 0) {
    r.fail(node, path, describe(node));
  }
  return node.text;
}

void readChoiceList(const Reading& r) {
  const int size = static_cast<int>(r.node.items.size());
  if (r.node.kind != Kind::kList || size < r.spec.count.min || size > r.spec.count.max) {
    r.failType();
  }
  std::vector<std::string> words;
  for (int i = 0; i < size; ++i) {
    const std::string path = fmt::format("{}[{}]", r.path, i);
    words.push_back(parseChoice(r, r.node.items[i], path));
    if (std::ranges::count(words, words.back()) > 1) {
      r.fail(r.node.items[i], path, inQuotes(words.back()) + " is given twice");
    }
  }
  target<std::vector<std::string>>(r) = words;
}

void readNumberList(const Reading& r) {
  const auto numbers = parseNumbers(r, r.node, r.path, r.spec.count.min, r.spec.count.max);
  if (std::holds_alternative<Vector3& (*)(ConfigDraft&)>(r.spec.target)) {
    target<Vector3>(r) = Eigen::Map<const Vector3>(numbers.data());
  } else {
    target<std::vector<double>>(r) = numbers;
  }
}

void readNumberTable(const Reading& r) {
  auto& table = target<Eigen::Matrix<double, 4, 8>>(r);
  if (r.node.kind != Kind::kList || static_cast<int>(r.node.items.size()) != r.spec.count.min) {
    r.failType();
  }
  for (int row = 0; row < r.spec.count.min; ++row) {
    const auto numbers = parseNumbers(r, r.node.items[row], fmt::format("{}[{}]", r.path, row),
                                      r.spec.columns, r.spec.columns);
    for (int column = 0; column < r.spec.columns; ++column) table(row, column) = numbers[column];
  }
}

void readSectionList(const Reading& r) {
  const int size = static_cast<int>(r.node.items.size());
  if (r.node.kind != Kind::kList || size < r.spec.count.min || size > r.spec.count.max) {
    r.failType();
  }
  for (int i = 0; i < size; ++i) {
    r.spec.begin(r.draft);
    readSection(r.node.items[i], r.spec.keys, fmt::format("{}[{}]", r.path, i), r.draft);
  }
}

void readValue(const Reading& r) {
  switch (r.spec.type) {
    case ValueType::kNumber:
      target<double>(r) = parseNumber<double>(r, r.node, r.path);
      return;
    case ValueType::kInteger:
      return readInteger(r);
    case ValueType::kBoolean:
      return readBoolean(r);
    case ValueType::kText:
      return readText(r);
    case ValueType::kChoice:
      target<std::string>(r) = parseChoice(r, r.node, r.path);
      return;
    case ValueType::kChoiceList:
      return readChoiceList(r);
    case ValueType::kNumberList:
      return readNumberList(r);
    case ValueType::kNumberTable:
      return readNumberTable(r);
    case ValueType::kSection:
      if (r.spec.begin) r.spec.begin(r.draft);
      return readSection(r.node, r.spec.keys, r.path, r.draft);
    case ValueType::kSectionList:
      return readSectionList(r);
  }
}

void readAbsent(const KeySpec& spec, const SourcePosition& at, const std::string& path,
                ConfigDraft& draft) {
  if (spec.presence == Presence::kRequired) {
    failAt(at, path, "is missing", "expected " + describeExpectation(spec));
  }
  if (spec.presence == Presence::kOptional) return;
  YamlNode empty_section{Kind::kMap, at};
  readValue({spec.type == ValueType::kSection ? empty_section
                                              : parseYaml({"the default", spec.default_value}),
             spec, path, draft});
}

void rejectUnknownKeys(const YamlNode& node, const std::vector<KeySpec>& keys,
                       const std::string& prefix) {
  std::vector<std::string> known;
  for (const KeySpec& spec : keys) known.push_back(spec.key);
  for (const YamlEntry& entry : node.entries) {
    if (std::ranges::count(known, entry.key) > 0) continue;
    const std::string nearest = nearestWord(entry.key, known);
    failAt(entry.key_at, prefix + entry.key, "unknown key",
           known.empty()     ? "expected none here"
           : nearest.empty() ? fmt::format("expected one of {}", fmt::join(known, ", "))
                             : fmt::format("expected perhaps '{}'", nearest));
  }
}

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
      return fmt::format("a list of {} lists of {} numbers{}", spec.count.min, spec.columns,
                         describeRange(spec.range));
    case ValueType::kSection:
      return "a section of keys";
    case ValueType::kSectionList:
      return fmt::format("a list of {}", describeCount(spec.count, "section"));
  }
  return "";
}

void readSection(const YamlNode& node, const std::vector<KeySpec>& keys, const std::string& path,
                 ConfigDraft& draft) {
  if (node.kind != Kind::kMap) {
    failAt(node.at, path.empty() ? "-" : path, describe(node),
           "expected a section of keys ({} for none)");
  }
  const std::string prefix = path.empty() ? "" : path + ".";
  rejectUnknownKeys(node, keys, prefix);
  for (const KeySpec& spec : keys) {
    const YamlNode* value = node.find(spec.key);
    if (value && value->kind != Kind::kNull) {
      readValue({*value, spec, prefix + spec.key, draft});
    } else {
      readAbsent(spec, value ? value->at : node.at, prefix + spec.key, draft);
    }
  }
}

}  // namespace tactus
