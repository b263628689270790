#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tactus/doctor/machine_files.h"

namespace tactus {

/// The [Service] section of a unit of systemd with its drop-ins.
struct UnitFile {
  std::string name;  ///< "tactusd.service", or "tactusd@.service"
  std::string path;  ///< of the unit itself
  bool is_masked = false;
  std::map<std::string, std::vector<std::string>> values;  ///< all lines of a key, in their order

  bool isSet(const std::string& key) const { return !value(key).empty(); }
  bool isOn(const std::string& key) const {
    const std::string text = value(key);
    return text == "yes" || text == "true" || text == "on" || text == "1";
  }
  /// Empty if it is not given, or reset. Of a key given several times the last.
  std::string value(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? "" : found->second.back();
  }

  /// Whether CapabilityBoundingSet= lets a process have it, and AmbientCapabilities= gives it to
  /// one that is not root's (systemd.exec(5)).
  bool mayHave(const std::string& capability) const;
  bool givesAmbient(const std::string& capability) const;
};

/// The unit `name`.service, or its template. nullopt: not installed.
std::optional<UnitFile> readUnit(const MachineRoot& root, const std::string& name);

}  // namespace tactus
