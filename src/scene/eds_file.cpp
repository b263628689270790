#include "tactus/scene/eds_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

namespace tactus {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view withoutBlanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string lowerCase(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::optional<std::int64_t> plainNumber(std::string_view text) noexcept {
  const bool is_negative = text.starts_with('-');
  if (is_negative) text.remove_prefix(1);
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text.starts_with('0')) {
    base = 8;
  }
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  if (error != std::errc() || stop != end || value > INT64_MAX) return std::nullopt;
  const auto number = static_cast<std::int64_t>(value);
  return is_negative ? -number : number;
}

bool isNodeId(std::string_view text) { return lowerCase(text) == "$nodeid"; }

bool areHexDigits(std::string_view text, std::size_t most) {
  return !text.empty() && text.size() <= most &&
         text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string_view withoutZeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1));
}

/// Lines of a file, one after the other.
class EdsLines {
 public:
  explicit EdsLines(const SourceFile& file)
      : rest_(file.text), at_{std::make_shared<std::string>(file.path), 0, 1} {
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  /// False at the end.
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = withoutBlanks(rest_.substr(0, end));
    at_.column = 1 + static_cast<int>(line.empty() ? 0 : line.data() - rest_.data());
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++at_.line;
    return true;
  }
  const SourcePosition& at() const { return at_; }

 private:
  std::string_view rest_;
  SourcePosition at_;
};

EdsSection& beginEdsSection(EdsFile& eds, std::string_view line, const SourcePosition& at) {
  const std::string_view name = withoutBlanks(line.substr(1, line.size() - 2));
  if (!line.ends_with(']') || name.empty())
    failAt(at, "-", inQuotes(line) + " is no name of a section", "expected [name]");
  const auto [found, is_new] = eds.sections.try_emplace(edsSectionKey(name));
  if (!is_new) {
    failAt(at, name, fmt::format("the section is there already, in line {}", found->second.at.line),
           "expected each section once");
  }
  found->second.name = name;
  found->second.at = at;
  return found->second;
}

/// A value ends where a comment begins: at a semicolon in front, or behind a blank.
std::string_view withoutComment(std::string_view text) {
  for (std::size_t at = text.find(';'); at != std::string_view::npos; at = text.find(';', at + 1))
    if (at == 0 || kBlank.find(text[at - 1]) != std::string_view::npos) return text.substr(0, at);
  return text;
}

void addEdsValue(EdsSection& section, std::string_view line, const SourcePosition& at) {
  const std::size_t equals = line.find('=');
  const std::string key = lowerCase(withoutBlanks(line.substr(0, std::min(equals, line.size()))));
  if (equals == std::string_view::npos || key.empty())
    failAt(at, section.name, inQuotes(line) + " is no value", "expected key=value, or [section]");
  const EdsValue value{std::string(withoutBlanks(withoutComment(line.substr(equals + 1)))), at};
  const auto [found, is_new] = section.values.try_emplace(key, value);
  if (is_new) return;
  failAt(at, section.name + "." + key,
         fmt::format("the key is there already, in line {}", found->second.at.line),
         "expected each key once a section");
}

/// A list of objects: as many as it says, each there once in all lists.
void readObjectList(const EdsSection& list, std::map<std::int64_t, SourcePosition>& objects) {
  constexpr const char* kCount = "SupportedObjects";
  const EdsValue* count = list.find(kCount);
  const std::string key = list.name + "." + kCount;
  if (!count) failAt(list.at, key, "is missing", "expected the number of objects in this list");
  const auto said = parseEdsNumber(count->text);
  std::int64_t listed = 0;
  for (const auto& [name, value] : list.values) {
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    ++listed;
    const auto object = parseEdsNumber(value.text);
    const std::string place = list.name + "." + name;
    if (!object || object->plus_node_id || object->value < 0 || object->value > 0xFFFF)
      failAt(value.at, place, inQuotes(value.text) + " is no object", "expected one as 0x6040");
    if (!objects.try_emplace(object->value, value.at).second)
      failAt(value.at, place, fmt::format("object {:04X} is listed twice", object->value),
             "expected each once");
  }
  if (said && said->value == listed && !said->plus_node_id) return;
  failAt(count->at, key,
         fmt::format("{} is not the number of objects listed", inQuotes(count->text)),
         fmt::format("expected {}, or a file that is whole", listed));
}

}  // namespace

std::optional<EdsNumber> parseEdsNumber(std::string_view text) noexcept {
  text = withoutBlanks(text);
  const std::size_t plus = text.find('+');
  if (plus == std::string_view::npos) {
    if (isNodeId(text)) return EdsNumber{0, true};
    const auto number = plainNumber(text);
    return number ? std::optional(EdsNumber{*number, false}) : std::nullopt;
  }
  const std::string_view left = withoutBlanks(text.substr(0, plus));
  const std::string_view right = withoutBlanks(text.substr(plus + 1));
  if (!isNodeId(left) && !isNodeId(right)) return std::nullopt;
  const auto number = plainNumber(isNodeId(left) ? right : left);
  return number ? std::optional(EdsNumber{*number, true}) : std::nullopt;
}

std::string edsSectionKey(std::string_view name) {
  std::string key = lowerCase(name);
  const std::size_t sub = key.find("sub");
  const std::string_view index = std::string_view(key).substr(0, std::min(sub, key.size()));
  if (!areHexDigits(index, 4)) return key;
  std::string result(withoutZeros(index));
  if (sub == std::string::npos) return result;
  const std::string_view subindex = std::string_view(key).substr(sub + 3);
  if (!areHexDigits(subindex, 2)) return key;
  return (result += "sub") += withoutZeros(subindex);
}

const EdsValue* EdsSection::find(std::string_view key) const {
  const auto found = values.find(lowerCase(key));
  return found == values.end() ? nullptr : &found->second;
}

const EdsSection* EdsFile::find(std::string_view key) const {
  const auto found = sections.find(edsSectionKey(key));
  return found == sections.end() ? nullptr : &found->second;
}

EdsFile parseEds(const SourceFile& file) {
  EdsLines lines(file);
  EdsFile eds{beginOf(file.path), {}, {}};
  EdsSection* section = nullptr;
  std::string_view line;
  while (lines.next(line)) {
    if (line.empty() || line.starts_with(';') || line.starts_with('#')) continue;
    if (line.starts_with('[')) {
      section = &beginEdsSection(eds, line, lines.at());
      continue;
    }
    if (!section)
      failAt(lines.at(), "-", inQuotes(line) + " is in no section", "expected [FileInfo] before");
    addEdsValue(*section, line, lines.at());
  }
  for (const char* const list : kEdsObjectLists)
    if (const EdsSection* const found = eds.find(list)) readObjectList(*found, eds.objects);
  if (eds.objects.empty())
    failAt(eds.begin, "MandatoryObjects", "no list of objects", "expected an EDS of CiA 306");
  return eds;
}

}  // namespace tactus
