#include "tactus/scene/yaml_word.h"

#include <algorithm>
#include <array>
#include <cctype>
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

}  // namespace

std::string yamlWord(std::string_view name) {
  const bool begins_plainly =
      name.starts_with("../") ||
      (!name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0);
  const bool is_plain =
      begins_plainly && std::ranges::all_of(name, isNameCharacter) && !isReserved(name);
  return is_plain ? std::string(name) : nlohmann::json(name).dump(-1, ' ', true);
}

}  // namespace tactus
