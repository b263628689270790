#include "tactus/scene/yaml_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

/// Behind the bracket that closes the one at `begin`. Of numbers and comments alone.
std::size_t endOfList(std::string_view text, std::size_t begin) {
  int depth = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (text[i] == '#') i = std::min(text.find('\n', i), text.size() - 1);
    if (text[i] == '[') ++depth;
    if (text[i] == ']' && --depth == 0) return i + 1;
  }
  return text.size();
}

/// Behind the last row, at `end`, of a table in brackets, or in lines of their own.
void addTableRow(const YamlNode& table, std::size_t end, const std::string& row,
                 const std::string& comment, std::string& text) {
  if (text[offsetAt(text, table.at)] == '[') {
    text.insert(end, ", " + row);
    return;
  }
  const std::size_t line_end = std::min(text.find('\n', end), text.size());
  const std::string indentation(static_cast<std::size_t>(table.at.column) - 1, ' ');
  text.insert(line_end, fmt::format("\n{}- {}  # {}", indentation, row, comment));
}

}  // namespace

std::string withRows(const SourceFile& file, std::string_view key,
                     const std::vector<std::string>& rows, const std::string& comment_of_new) {
  const YamlNode root = parseYaml(file);
  const YamlNode* const table = findGiven(root, key);
  const bool is_table = table && table->kind == YamlNode::Kind::kList && !table->items.empty();
  if (!is_table) failAt(locate(root, key), key, "is no list of rows", "expected one to write into");
  const std::size_t count = table->items.size();
  if (rows.size() < count || rows.size() > count + 1)
    failAt(table->at, key, fmt::format("has {} rows", count),
           fmt::format("expected {}", rows.size()));
  std::string text = file.text;
  for (std::size_t i = count; i-- > 0;) {
    const YamlNode& row = table->items[i];
    const std::size_t begin = offsetAt(text, row.at);
    if (row.kind != YamlNode::Kind::kList || text[begin] != '[')
      failAt(row.at, fmt::format("{}[{}]", key, i), "a row without brackets",
             "expected one as [1, 2], to be replaced");
    const std::size_t end = endOfList(text, begin);
    if (i + 1 == count && rows.size() > count)
      addTableRow(*table, end, rows.back(), comment_of_new, text);
    text.replace(begin, end - begin, rows[i]);
  }
  return text;
}

}  // namespace tactus
