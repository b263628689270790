#include "tactus/doctor/unit_file.h"

#include <array>
#include <set>
#include <sstream>
#include <utility>

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

/// An even number of backslashes at the end of a line are as many of them.
bool goesOn(std::string_view line) {
  const std::size_t last = line.find_last_not_of('\\');
  const std::size_t backslashes = line.size() - (last == line.npos ? 0 : last + 1);
  return backslashes % 2 == 1;
}

/// Lines without comments, those that end with a backslash with the next one behind them, as
/// systemd.syntax(7) has it.
std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  std::string continued;
  for (std::string line; std::getline(in, line);) {
    if (line.ends_with('\r')) line.pop_back();
    line.erase(0, line.find_first_not_of(" \t"));
    if (line.starts_with('#') || line.starts_with(';')) continue;
    continued += line;
    if (goesOn(line)) {
      continued.back() = ' ';
    } else {
      lines.push_back(std::exchange(continued, ""));
    }
  }
  lines.push_back(continued);
  return lines;
}

void addValues(const std::string& text, UnitFile& unit) {
  bool is_service = false;
  for (const std::string& part : linesOf(text)) {
    const std::string line = trimmed(part);
    const std::size_t equals = line.find('=');
    if (line.starts_with('[')) is_service = line == "[Service]";
    if (!is_service || equals == line.npos) continue;
    unit.values[trimmed(line.substr(0, equals))].push_back(trimmed(line.substr(equals + 1)));
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

/// These, or all but these.
struct Capabilities {
  bool is_all_but = false;
  std::set<std::string> names;

  bool has(const std::string& name) const { return is_all_but != names.contains(name); }
  void set(const std::string& name, bool is_in) {
    if (is_in == is_all_but) {
      names.erase(name);
    } else {
      names.insert(name);
    }
  }
};

/// Each line adds to the set, or with a tilde takes from it; one without a name begins it anew, and
/// so does any as long as the set is what it is by itself.
Capabilities capabilitiesOf(const UnitFile& unit, const std::string& key, bool are_all_at_first) {
  Capabilities set{are_all_at_first, {}};
  const auto found = unit.values.find(key);
  if (found == unit.values.end()) return set;
  for (const std::string& line : found->second) {
    const bool is_taken = line.starts_with('~');
    const auto words = split(std::string_view(line).substr(is_taken ? 1 : 0));
    const bool is_as_at_first = set.names.empty() && set.is_all_but == are_all_at_first;
    if (words.empty() || is_as_at_first) set = {is_taken, {}};
    for (const std::string_view word : words) set.set(std::string(word), !is_taken);
  }
  return set;
}

}  // namespace

bool UnitFile::mayHave(const std::string& capability) const {
  return capabilitiesOf(*this, "CapabilityBoundingSet", true).has(capability);
}

bool UnitFile::givesAmbient(const std::string& capability) const {
  return capabilitiesOf(*this, "AmbientCapabilities", false).has(capability);
}

std::optional<UnitFile> readUnit(const MachineRoot& root, const std::string& name) {
  for (const char* suffix : {".service", "@.service"}) {
    for (const char* folder : kFolders) {
      UnitFile unit;
      unit.name = name + suffix;
      const fs::path path = root / folder / unit.name;
      const auto text = readText(path);
      if (!text) continue;
      unit.path = "/" + path.lexically_relative(root).string();
      unit.is_masked = text->empty();  // as /dev/null, to which it leads
      addValues(*text, unit);
      addDropIns(root, unit);
      return unit;
    }
  }
  return std::nullopt;
}

}  // namespace tactus
