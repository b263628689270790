#include "tactus/scene/table_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>

#include "tactus/scene/key_table.h"
#include "tactus/scene/number_text.h"
#include "tactus/scene/unknown_keys.h"

namespace tactus {
namespace {

using Kind = YamlNode::Kind;

/// What `tactus init` writes where somebody has to; a number or a word of its own says so itself.
constexpr const char* kFillIn = "FILL_IN";

/// What the values of a file have in common.
struct File {
  const YamlNode& root;
  NamedNumbers& numbers;
  OtherFile other;
};

/// One value on its way from a node to a config.
struct Reading {
  const YamlNode& node;
  const KeySpec& spec;
  std::string path;
  void* owner;  ///< the struct that the row is of
  File& file;

  [[noreturn]] void fail(const YamlNode& at, const std::string& key,
                         const std::string& problem) const {
    failAt(at.at, key, problem, "expected " + describeExpectation(spec));
  }
  [[noreturn]] void failType() const { fail(node, path, describe(node)); }
};

void readSection(const YamlNode& node, const std::vector<KeySpec>& keys, const std::string& path,
                 void* owner, File& file);

std::from_chars_result fromChars(std::string_view text, double& value) {
  return std::from_chars(text.data(), text.data() + text.size(), value);
}

/// Whole numbers may be hexadecimal: 0x100.
std::from_chars_result fromChars(std::string_view text, std::int64_t& value) {
  const bool is_hex = text.starts_with("0x");
  const std::string_view digits = text.substr(is_hex ? 2 : 0);
  if (is_hex && digits.starts_with('-')) return {digits.data(), std::errc::invalid_argument};
  return std::from_chars(digits.data(), text.data() + text.size(), value, is_hex ? 16 : 10);
}

/// "0.1" of "0,1"; empty if the text is no number with a decimal comma.
std::string withDecimalPoint(std::string text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return "";
  text[comma] = '.';
  double number = 0.0;
  const auto [stop, error] = fromChars(withoutPlus(text), number);
  return error == std::errc() && stop == text.data() + text.size() ? text : "";
}

/// T: double or std::int64_t.
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
  const std::string point = withDecimalPoint(node.text);
  if (!point.empty() && r.spec.type != ValueType::kInteger) {
    failAt(node.at, path, inQuotes(node.text) + " is not a number but has a decimal comma",
           "expected " + describeExpectation(r.spec) + ", with a decimal point: " + point);
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
  r.file.numbers.emplace_back(path, number);
  return value;
}

std::vector<double> parseNumbers(const Reading& r, const YamlNode& node, const std::string& path,
                                 int min, int max) {
  const int size = static_cast<int>(node.items.size());
  if (node.kind != Kind::kList || size < min || size > max) r.fail(node, path, describe(node));
  std::vector<double> numbers;
  numbers.reserve(node.items.size());
  for (int i = 0; i < size; ++i) {
    numbers.push_back(parseNumber<double>(r, node.items[i], fmt::format("{}[{}]", path, i)));
  }
  return numbers;
}

std::string parseChoice(const Reading& r, const YamlNode& node, const std::string& path) {
  const auto& choices = r.spec.choices;
  if (node.kind != Kind::kScalar || std::ranges::count(choices, node.text) == 0) {
    r.fail(node, path, describe(node));
  }
  return node.text;
}

void requireList(const Reading& r) {
  const int size = static_cast<int>(r.node.items.size());
  if (r.node.kind != Kind::kList || size < r.spec.count.min || size > r.spec.count.max) {
    r.failType();
  }
}

std::vector<std::string> parseChoices(const Reading& r) {
  if (r.spec.type == ValueType::kChoice) return {parseChoice(r, r.node, r.path)};
  requireList(r);
  std::vector<std::string> words;
  for (std::size_t i = 0; i < r.node.items.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", r.path, i);
    words.push_back(parseChoice(r, r.node.items[i], path));
    if (std::ranges::count(words, words.back()) > 1) {
      r.fail(r.node.items[i], path, inQuotes(words.back()) + " is given twice");
    }
  }
  return words;
}

/// Reads a value into its place, by the place's type.
struct ValueReader {
  const Reading& r;

  void operator()(double* number) const { *number = parseNumber<double>(r, r.node, r.path); }
  template <std::integral T>
  void operator()(T* number) const {  // the row's range is within that of T
    *number = static_cast<T>(parseNumber<std::int64_t>(r, r.node, r.path));
  }
  void operator()(bool* truth) const {
    const bool is_word = r.node.kind == Kind::kScalar && !r.node.quoted;
    if (!is_word || (r.node.text != "true" && r.node.text != "false")) r.failType();
    *truth = r.node.text == "true";
  }
  void operator()(std::string* text) const {
    if (r.node.kind != Kind::kScalar || r.node.text.empty()) r.failType();
    if (r.node.text == kFillIn) r.fail(r.node, r.path, inQuotes(kFillIn) + " is left");
    *text = r.node.text;
  }
  void operator()(std::vector<double>* numbers) const {
    *numbers = parseNumbers(r, r.node, r.path, r.spec.count.min, r.spec.count.max);
  }
  void operator()(Vector3* vector) const {
    *vector = Eigen::Map<const Vector3>(parseNumbers(r, r.node, r.path, 3, 3).data());
  }
  void operator()(TactileChannels* channels) const {
    requireList(r);
    channels->moment_x.reset();
    for (std::size_t row = 0; row < r.node.items.size(); ++row) {
      const auto numbers = parseNumbers(r, r.node.items[row], fmt::format("{}[{}]", r.path, row),
                                        r.spec.columns, r.spec.columns);
      const Eigen::Map<const TactileChannelRow> read(numbers.data());
      if (row < 4)
        channels->calibration.row(static_cast<int>(row)) = read;
      else
        channels->moment_x = read;
    }
  }
  void operator()(const WordsTarget& words) const { words.set(parseChoices(r)); }
};

/// What a section without keys means, where there may be one.
std::string sectionExpectation(const KeySpec& spec) {
  const auto isRequired = [](const KeySpec& key) { return key.presence == Presence::kRequired; };
  if (std::ranges::any_of(spec.keys, isRequired)) return "a section of keys";
  if (spec.presence == Presence::kOptional)
    return "a section of keys ({} for its defaults, null for none)";
  return "a section of keys ({} for none)";
}

void requireSection(const Reading& r) {
  if (r.node.kind == Kind::kMap) return;
  const bool is_list_instead = r.node.kind == Kind::kList && !r.spec.same_as.empty();
  failAt(r.node.at, r.path, describe(r.node),
         "expected " + sectionExpectation(r.spec) +
             (is_list_instead ? "; perhaps " + r.spec.same_as + " is meant" : ""));
}

void readSectionList(const Reading& r) {
  requireList(r);
  for (std::size_t i = 0; i < r.node.items.size(); ++i) {
    readSection(r.node.items[i], r.spec.keys, fmt::format("{}[{}]", r.path, i),
                r.spec.enter(r.owner), r.file);
  }
}

void readPresent(const Reading& r) {
  const Needs& needs = r.spec.needs;
  if (!needs.section.empty() && !findGiven(r.file.root, needs.section)) {
    failAt(r.node.at, r.path, needs.problem, "expected " + needs.expectation);
  }
  if (r.spec.type == ValueType::kSectionList) return readSectionList(r);
  if (r.spec.type == ValueType::kSection) {
    requireSection(r);
    return readSection(r.node, r.spec.keys, r.path, r.spec.enter(r.owner), r.file);
  }
  std::visit(ValueReader{r}, r.spec.target(r.owner));
}

/// Adds a value to the numbers of a file.
struct NumberAdder {
  const std::string& path;
  NamedNumbers& numbers;

  void operator()(Vector3* vector) const {
    for (int i = 0; i < 3; ++i) numbers.emplace_back(fmt::format("{}[{}]", path, i), (*vector)[i]);
  }
  template <class T>
  void operator()(const T& value) const {
    using Value = std::remove_pointer_t<T>;
    if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
      numbers.emplace_back(path, static_cast<double>(*value));
    }
  }
};

/// A new config has its defaults already; they belong to the file's numbers.
void readAbsent(const KeySpec& spec, const SourcePosition& at, const std::string& path, void* owner,
                File& file) {
  if (spec.presence == Presence::kRequired) {
    failAt(at, path, "is missing", "expected " + describeExpectation(spec));
  }
  if (spec.presence == Presence::kOptional) return;
  const YamlNode empty_section{Kind::kMap, at};
  if (spec.enter) return readSection(empty_section, spec.keys, path, spec.enter(owner), file);
  std::visit(NumberAdder{path, file.numbers}, spec.target(owner));
}

void readSection(const YamlNode& node, const std::vector<KeySpec>& keys, const std::string& path,
                 void* owner, File& file) {
  if (node.kind != Kind::kMap) {
    failAt(node.at, path.empty() ? "-" : path, describe(node), "expected a section of keys");
  }
  const std::string prefix = path.empty() ? "" : path + ".";
  rejectUnknownKeys(node, keys, prefix, file.other);
  for (const KeySpec& spec : keys) {
    const YamlNode* value = node.find(spec.key);
    if (value && value->kind != Kind::kNull) {
      readPresent({*value, spec, prefix + spec.key, owner, file});
    } else {
      readAbsent(spec, value ? value->at : node.at, prefix + spec.key, owner, file);
    }
  }
}

template <class Config>
Config readConfig(const std::vector<KeySpec>& keys, File file) {
  Config config;
  readSection(file.root, keys, "", &config, file);
  return config;
}

}  // namespace

SceneConfig readSceneConfig(const YamlNode& root, NamedNumbers& numbers) {
  return readConfig<SceneConfig>(
      sceneKeys(), {root, numbers, {robotKeys(), "the robot's file, which the key robot names"}});
}

RobotConfig readRobotConfig(const YamlNode& root, NamedNumbers& numbers) {
  return readConfig<RobotConfig>(robotKeys(), {root, numbers, {sceneKeys(), "a scene"}});
}

}  // namespace tactus
