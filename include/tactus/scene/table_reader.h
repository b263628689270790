#pragma once

#include "tactus/scene/key_table.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// Checks a file's tree against its table and writes every value, or its default, to the draft.
/// Throws InputError at the first value that the table does not allow. `path` is the dotted path of
/// `node`, empty at the top.
void readSection(const YamlNode& node, const std::vector<KeySpec>& keys, const std::string& path,
                 ConfigDraft& draft);

}  // namespace tactus
