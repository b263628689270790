#include "tactus/scene/unknown_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

using Kind = YamlNode::Kind;

bool areDigits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// {x_m: 0,7} is x_m: 0 and a key 7 without a value.
void refuseDecimalComma(const YamlNode& node, const YamlEntry& entry, const std::string& prefix) {
  if (!areDigits(entry.key) || &entry == &node.entries.front()) return;
  const YamlEntry& before = *(&entry - 1);
  if (entry.value.kind != Kind::kEmpty || !areDigits(before.value.text)) return;
  const std::string digits = before.value.text + "," + entry.key;
  failAt(before.value.at, prefix + before.key, inQuotes(digits) + " has a decimal comma",
         "expected a decimal point: " + before.value.text + "." + entry.key);
}

/// path: dotted, entries of lists with their index.
bool hasKey(const std::vector<KeySpec>& keys, std::string_view path) {
  const std::size_t dot = path.find('.');
  const std::string_view key = path.substr(0, std::min(dot, path.find('[')));
  const auto found = std::ranges::find(keys, key, &KeySpec::key);
  if (found == keys.end()) return false;
  return dot == std::string_view::npos || hasKey(found->keys, path.substr(dot + 1));
}

}  // namespace

void rejectUnknownKeys(const YamlNode& node, const std::vector<KeySpec>& keys,
                       const std::string& prefix, const OtherFile& other) {
  std::vector<std::string> known;
  known.reserve(keys.size());
  for (const KeySpec& spec : keys) known.push_back(spec.key);
  for (const YamlEntry& entry : node.entries) {
    if (std::ranges::count(known, entry.key) > 0) continue;
    refuseDecimalComma(node, entry, prefix);
    if (hasKey(other.keys, prefix + entry.key)) {
      failAt(entry.key_at, prefix + entry.key, "unknown key here",
             std::string("expected in ") + other.name);
    }
    const std::string within = keyWithin(keys, entry.key);
    const std::string nearest = within.empty() ? nearestWord(entry.key, known) : within;
    failAt(entry.key_at, prefix + entry.key, "unknown key",
           known.empty()     ? "expected none here"
           : nearest.empty() ? fmt::format("expected one of {}", fmt::join(known, ", "))
                             : fmt::format("expected perhaps '{}'", nearest));
  }
}

}  // namespace tactus
