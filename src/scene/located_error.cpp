#include "tactus/scene/located_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace tactus {
namespace {

constexpr std::size_t kMaxShownBytes = 48;
constexpr std::size_t kMaxShownKeyBytes = 120;

std::uint32_t decodeUtf8(std::string_view character) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(character[i]); };
  if (character.size() == 1) return byte(0);
  std::uint32_t code = byte(0) & (0x7Fu >> character.size());
  for (std::size_t i = 1; i < character.size(); ++i) code = code << 6 | (byte(i) & 0x3Fu);
  return code;
}

bool isHarmless(std::uint32_t code) noexcept {
  const bool is_control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool is_separator_or_mark =
      (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
  return !is_control && !is_separator_or_mark;
}

/// A key as part of a line whose parts end at colons and are not empty.
std::string escapedKey(std::string_view key) {
  if (key.empty()) return "-";
  std::string result = escaped(key);
  for (std::size_t at = 0; (at = result.find(':', at)) != std::string::npos;) {
    result.replace(at, 1, "\\x3a");
  }
  return result;
}

std::string shortened(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return std::string(text);
  std::size_t end = 0;
  while (end < max_bytes) {
    end += std::max<std::size_t>(1, utf8CharacterLength(text.substr(end)));
  }
  return std::string(text.substr(0, std::min(end, text.size()))) + "...";
}

/// Levenshtein distance.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

std::size_t utf8CharacterLength(std::string_view text) noexcept {
  if (text.empty()) return 0;
  const auto lead = static_cast<std::uint8_t>(text[0]);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<std::uint8_t>(text[i]) & 0xC0) != 0x80) return 0;
  }
  const std::uint32_t code = decodeUtf8(text.substr(0, length));
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  return overlong || is_surrogate || code > 0x10FFFF ? 0 : length;
}

std::string escaped(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = utf8CharacterLength(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length > 0 && isHarmless(decodeUtf8(character))) {
      result += character;
    } else {
      for (const char c : character) result += fmt::format("\\x{:02x}", static_cast<uint8_t>(c));
    }
    text.remove_prefix(character.size());
  }
  return result;
}

std::string inQuotes(std::string_view user_text) {
  return "'" + escaped(shortened(user_text, kMaxShownBytes)) + "'";
}

void failAt(const SourcePosition& at, std::string_view key, std::string_view problem,
            std::string_view expectation) {
  throw LocatedError({at.file && !at.file->empty() ? escaped(*at.file) : "-",
                      escapedKey(shortened(key, kMaxShownKeyBytes)), at.line, at.column,
                      escaped(problem), escaped(expectation)});
}

SourcePosition beginOf(std::string path) {
  return {std::make_shared<std::string>(std::move(path)), 1, 1};
}

SourcePosition positionAt(std::shared_ptr<const std::string> file, std::string_view text,
                          std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return {std::move(file), 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')),
          1 + static_cast<int>(before.size() - line_start)};
}

std::size_t offsetAt(std::string_view text, const SourcePosition& at) {
  std::size_t offset = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;  // a byte order mark
  for (int line = 1; line < at.line; ++line) offset = text.find('\n', offset) + 1;
  return offset + static_cast<std::size_t>(at.column) - 1;
}

std::string nearestWord(std::string_view word, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, word.size() / 3) + 1;
  if (word.size() > kMaxShownBytes) return nearest;
  for (const std::string& candidate : candidates) {
    // A forgotten unit is the most likely mistake, and a long one.
    const bool is_start = word.size() >= 4 && candidate.starts_with(word);
    const std::size_t distance = is_start ? 1 : editDistance(word, candidate);
    if (distance >= best || distance >= candidate.size()) continue;
    best = distance;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace tactus
