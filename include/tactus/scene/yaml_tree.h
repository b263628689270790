#pragma once

#include <string>
#include <vector>

#include "tactus/scene/located_error.h"
#include "tactus/scene/scene.h"

/// YAML as this project accepts it: one document of maps, lists and scalars, nothing that makes two
/// places of a file depend on each other (anchors, aliases, tags) and no key twice.
namespace tactus {

struct YamlEntry;

/// A value and where it stands.
struct YamlNode {
  enum class Kind { kEmpty, kNull, kScalar, kList, kMap };

  YamlNode() = default;
  YamlNode(Kind kind, SourcePosition at, std::string text = {});

  Kind kind = Kind::kEmpty;  ///< kNull: `~` or `null` was written; kEmpty: nothing was
  SourcePosition at;
  std::string text;     ///< of a scalar
  bool quoted = false;  ///< a quoted scalar is text, whatever it looks like
  std::vector<YamlNode> items;
  std::vector<YamlEntry> entries;

  /// The value of a key of a map; null if there is none.
  const YamlNode* find(std::string_view key) const;
  YamlNode* find(std::string_view key);
};

struct YamlEntry {
  std::string key;
  SourcePosition key_at;
  YamlNode value;
};

/// Throws InputError. A file without content is an empty node.
YamlNode parseYaml(const SourceFile& file);

/// What a value is, for errors: "a list", "text 'abc'".
std::string describe(const YamlNode& node);

/// Lays `overlay` over `base`: maps merge key by key, everything else replaces.
void mergeYaml(YamlNode& base, YamlNode overlay);

/// Lays one value of the command line over a tree, e.g. `simulation.obstacles[0].x_m`; of the key,
/// the tree has what follows its first `skipped` bytes. Missing maps on the way are made; list
/// entries must exist. Throws InputError at `--set key:1:1`.
void applyOverride(YamlNode& root, const Override& setting, std::string_view path);

/// The value of a dotted path; null if it is absent or removed by `~`.
const YamlNode* findGiven(const YamlNode& root, std::string_view path);

/// Where the value of a dotted path stands; of the nearest value above it if there is none.
SourcePosition locate(const YamlNode& root, std::string_view path);

}  // namespace tactus
