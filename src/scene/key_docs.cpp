#include "tactus/scene/key_docs.h"

#include <fmt/format.h>

namespace tactus {
namespace {

void addRows(const std::vector<KeySpec>& keys, const std::string& prefix,
             std::vector<KeyRow>& rows) {
  for (const KeySpec& spec : keys) {
    rows.push_back({prefix + spec.key, &spec});
    if (!spec.same_as.empty()) continue;
    const bool is_list = spec.type == ValueType::kSectionList;
    addRows(spec.keys, prefix + spec.key + (is_list ? "[]." : "."), rows);
  }
}

/// `list[0].key` as `list.key`.
std::string withoutIndices(std::string_view path) {
  std::string result;
  bool is_index = false;
  for (const char c : path) {
    is_index = is_index || c == '[';
    if (!is_index) result += c;
    if (c == ']') is_index = false;
  }
  return result;
}

/// A path below a section that is the same as a list, as one of that list.
std::string withList(const std::vector<KeySpec>& keys, const std::string& path) {
  for (const KeySpec& spec : keys) {
    if (!spec.same_as.empty() && path.starts_with(spec.key + "."))
      return spec.same_as + path.substr(spec.key.size());
  }
  return path;
}

}  // namespace

std::array<FileFormat, 2> fileFormats() {
  return {FileFormat{"scene", sceneKeys()}, FileFormat{"robot", robotKeys()}};
}

std::vector<KeyRow> keyRows(const std::vector<KeySpec>& keys) {
  std::vector<KeyRow> rows;
  addRows(keys, "", rows);
  return rows;
}

std::string keyFacts(const KeySpec& spec) {
  std::string text = describeExpectation(spec);
  if (spec.presence == Presence::kRequired) {
    text += "; required";
  } else if (!spec.default_value.empty()) {
    text += "; default " + spec.default_value;
  } else {
    text += "; optional";
  }
  if (!spec.needs.section.empty()) text += "; only with " + spec.needs.section;
  if (!spec.symbol.empty()) text += "; symbol " + spec.symbol;
  if (spec.context != KeyContext::kRestart) text += fmt::format("; {}", contextName(spec.context));
  return text;
}

std::vector<KeyRow> findKeyRows(const std::vector<KeySpec>& keys, std::string_view path) {
  const std::string wanted = "." + withList(keys, withoutIndices(path));
  std::vector<KeyRow> found;
  for (KeyRow& row : keyRows(keys)) {
    const std::string words = "." + withoutIndices(row.path);
    if (words.ends_with(wanted) || words.find(wanted + ".") != std::string::npos ||
        (!path.empty() && row.spec->symbol == path))
      found.push_back(std::move(row));
  }
  return found;
}

}  // namespace tactus
