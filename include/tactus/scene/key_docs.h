#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/key_table.h"

/// What users read about the files' keys, written from the key tables.
namespace tactus {

/// A kind of file.
struct FileFormat {
  std::string_view name;  ///< "scene"
  const std::vector<KeySpec>& keys;
};

/// Scene and robot.
std::array<FileFormat, 2> fileFormats();

/// A row of a table with its dotted path; what stands in a list of sections as `list[].key`.
struct KeyRow {
  std::string path;
  const KeySpec* spec;
};

/// All rows, depth first.
std::vector<KeyRow> keyRows(const std::vector<KeySpec>& keys);

/// What a row allows, what its absence means and its symbol: "a number > 0 in s; default 0.1;
/// symbol T".
std::string keyFacts(const KeySpec& spec);

/// The rows whose path is `path` or ends with it, and all below them, and those whose symbol it is;
/// an index counts as any.
std::vector<KeyRow> findKeyRows(const std::vector<KeySpec>& keys, std::string_view path);

/// The page tactus-<name>(5) as roff.
std::string manualPage(const FileFormat& format);

/// A JSON schema (draft 2020-12) of what the table says about single keys; keys that have to fit
/// each other are left to `tactus check`.
std::string jsonSchema(const FileFormat& format);

}  // namespace tactus
