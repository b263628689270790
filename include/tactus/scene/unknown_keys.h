#pragma once

#include <string>
#include <vector>

#include "tactus/scene/key_table.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// The other one of scene and robot description.
struct OtherFile {
  const std::vector<KeySpec>& keys;
  const char* name;  ///< behind "expected in"
};

/// Throws InputError at the first key of a section that its rows do not have, with what may have
/// been meant: a key of the other file, one further down, a similar one. prefix: of the section's
/// keys, "" at the top.
void rejectUnknownKeys(const YamlNode& node, const std::vector<KeySpec>& keys,
                       const std::string& prefix, const OtherFile& other);

}  // namespace tactus
