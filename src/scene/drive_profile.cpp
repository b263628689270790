#include "tactus/scene/drive_profile.h"

#include <fmt/format.h>

#include <string>

#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

/// What of the profile a word of `without` switches off; null: it is no such word.
bool* switchedOff(const YamlNode& word, DriveProfile& profile) {
  if (word.kind != YamlNode::Kind::kScalar) return nullptr;
  if (word.text == "quick_stop_option") return &profile.has_quick_stop_option;
  if (word.text == "velocity_unit") return &profile.has_velocity_unit;
  if (word.text == "speed_limit") return &profile.has_speed_limit;
  return nullptr;
}

void readWithout(const YamlNode& list, DriveProfile& profile) {
  const char* const expectation =
      "expected a list of words: quick_stop_option, velocity_unit, speed_limit";
  if (list.kind != YamlNode::Kind::kList || list.items.empty())
    failAt(list.at, "without", describe(list), expectation);
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const YamlNode& word = list.items[i];
    const std::string key = fmt::format("without[{}]", i);
    bool* const has = switchedOff(word, profile);
    if (!has) failAt(word.at, key, describe(word), expectation);
    if (!*has) failAt(word.at, key, inQuotes(word.text) + " is given twice", expectation);
    *has = false;
  }
}

}  // namespace

DriveProfile parseDriveProfile(const SourceFile& file) {
  const YamlNode root = parseYaml(file);
  if (root.kind != YamlNode::Kind::kMap)
    failAt(root.at, "-", describe(root), "expected the keys source and without");
  DriveProfile profile;
  for (const YamlEntry& entry : root.entries) {
    if (entry.key == "without") {
      readWithout(entry.value, profile);
    } else if (entry.key != "source") {
      failAt(entry.key_at, entry.key, "unknown key", "expected one of source, without");
    } else if (entry.value.kind != YamlNode::Kind::kScalar || entry.value.text.empty()) {
      failAt(entry.value.at, "source", describe(entry.value), "expected text");
    }
  }
  if (!root.find("source"))
    failAt(root.at, "source", "is missing", "expected where the drive shows what the file says");
  return profile;
}

}  // namespace tactus
