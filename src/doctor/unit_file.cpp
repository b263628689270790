#include "tactus/doctor/unit_file.h"

#include <array>

namespace tactus {
namespace {

namespace fs = std::filesystem;

/// In the order in which the first one wins.
constexpr std::array kFolders = {"etc/systemd/system", "run/systemd/system",
                                 "usr/local/lib/systemd/system", "usr/lib/systemd/system",
                                 "lib/systemd/system"};

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

/// Sets that each line adds to, until an empty one begins them anew (systemd.exec(5)).
bool isAdded(std::string_view key) {
  return key == "AmbientCapabilities" || key == "CapabilityBoundingSet";
}

void addValue(const std::string& key, const std::string& text, UnitFile& unit) {
  std::string& value = unit.values[key];
  const bool is_more = isAdded(key) && !text.empty() && !value.empty();
  value = is_more ? value + " " + text : text;
}

void addValues(const std::string& text, UnitFile& unit) {
  bool is_service = false;
  for (const std::string_view part : split(text, "\n")) {
    const std::string line = trimmed(part);
    const std::size_t equals = line.find('=');
    if (line.starts_with('[')) is_service = line == "[Service]";
    if (!is_service || equals == line.npos || line[0] == '#' || line[0] == ';') continue;
    addValue(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)), unit);
  }
}

/// A drop-in hides those of the same name in folders behind; all are read in the order of names.
void addDropIns(const MachineRoot& root, UnitFile& unit) {
  std::map<std::string, fs::path> files;
  std::error_code none;
  for (const char* folder : kFolders)
    for (const auto& entry : fs::directory_iterator(root / folder / (unit.name + ".d"), none))
      if (entry.path().extension() == ".conf") files.emplace(entry.path().filename(), entry.path());
  for (const auto& [name, path] : files) addValues(readText(path).value_or(""), unit);
}

}  // namespace

std::optional<UnitFile> readUnit(const MachineRoot& root, const std::string& name) {
  for (const char* suffix : {".service", "@.service"}) {
    for (const char* folder : kFolders) {
      UnitFile unit{name + suffix, "", {}};
      const fs::path path = root / folder / unit.name;
      const auto text = readText(path);
      if (!text) continue;
      unit.path = "/" + path.lexically_relative(root).string();
      addValues(*text, unit);
      addDropIns(root, unit);
      return unit;
    }
  }
  return std::nullopt;
}

}  // namespace tactus
