#include "tactus/scene/yaml_word.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace tactus {
namespace {

/// Letters of ASCII alone, whatever the locale.
bool isNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.' || c == '/';
}

/// YAML's other values, of its older version, too.
bool isReserved(std::string_view name) {
  constexpr std::array<std::string_view, 10> kReserved = {"null", "true", "false", "yes", "no",
                                                          "on",   "off",  "y",     "n",   "inf"};
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::count(kReserved, lower) > 0;
}

/// JSON has characters beyond 16 bits as two numbers, which YAML takes for none: as one.
std::string withWholeCharacters(const std::string& json) {
  constexpr std::size_t kEscape = 6;  // characters of one number
  const auto unit = [&json](std::size_t at) {
    return static_cast<std::uint32_t>(std::stoul(json.substr(at + 2, 4), nullptr, 16));
  };
  std::string text;
  for (std::size_t i = 0; i < json.size();) {
    const bool is_escape = json[i] == '\\';
    const std::uint32_t high = is_escape && json[i + 1] == 'u' ? unit(i) : 0;
    if (high >= 0xD800 && high < 0xDC00) {
      const std::uint32_t low = unit(i + kEscape);
      text += fmt::format("\\U{:08x}", 0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00));
      i += 2 * kEscape;
      continue;
    }
    const std::size_t size = is_escape ? 2 : 1;
    text += json.substr(i, size);
    i += size;
  }
  return text;
}

}  // namespace

std::string yamlWord(std::string_view name) {
  const bool begins_plainly =
      name.starts_with("../") ||
      (!name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0);
  const bool is_plain =
      begins_plainly && std::ranges::all_of(name, isNameCharacter) && !isReserved(name);
  return is_plain ? std::string(name)
                  : withWholeCharacters(nlohmann::json(name).dump(-1, ' ', true));
}

}  // namespace tactus
