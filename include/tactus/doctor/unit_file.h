#pragma once

#include <map>
#include <optional>
#include <string>

#include "tactus/doctor/machine_files.h"

namespace tactus {

/// The [Service] section of a unit of systemd with its drop-ins.
struct UnitFile {
  std::string name;  ///< "tactusd.service", or "tactusd@.service"
  std::string path;  ///< of the unit itself
  std::map<std::string, std::string> values;

  bool isSet(const std::string& key) const { return !value(key).empty(); }
  bool isOn(const std::string& key) const {
    const std::string text = value(key);
    return text == "yes" || text == "true" || text == "on" || text == "1";
  }
  /// Empty if it is not given, or reset. Of a key given several times the last,
  /// of capabilities all.
  std::string value(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? "" : found->second;
  }
};

/// The unit `name`.service, or its template. nullopt: not installed.
std::optional<UnitFile> readUnit(const MachineRoot& root, const std::string& name);

}  // namespace tactus
