#include "tactus/scene/yaml_edit.h"

#include <algorithm>
#include <vector>

#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

using Words = std::vector<std::string>;

Words split(std::string_view key) {
  Words words;
  while (!key.empty()) {
    const std::size_t dot = std::min(key.find('.'), key.size());
    words.emplace_back(key.substr(0, dot));
    key.remove_prefix(std::min(dot + 1, key.size()));
  }
  return words;
}

std::size_t byteAt(std::string_view text, const SourcePosition& at) {
  std::size_t offset = 0;
  for (int line = 1; line < at.line; ++line) offset = text.find('\n', offset) + 1;
  return offset + static_cast<std::size_t>(at.column) - 1;
}

/// Of the scalar that begins there.
std::size_t tokenLength(std::string_view text) {
  const char quote = text.empty() ? '\0' : text[0];
  if (quote == '"' || quote == '\'') {
    std::size_t end = 1;
    while (end < text.size() && text[end] != quote) end += text[end] == '\\' ? 2 : 1;
    return std::min(end + 1, text.size());
  }
  return std::min(text.find_first_of(" \t\r\n,}#"), text.size());
}

/// "a: {b: value}"
std::string flowText(const Words& words, std::size_t first, const std::string& value) {
  std::string text;
  for (std::size_t i = first; i < words.size(); ++i) {
    text += i > first ? "{" : "";
    text += words[i];
    text += ": ";
  }
  text += value;
  return text + std::string(words.size() - first - 1, '}');
}

/// "a:\n  b: value\n", as deep as `indentation`.
std::string blockText(const Words& words, std::size_t first, std::size_t indentation,
                      const std::string& value) {
  std::string text;
  for (std::size_t i = first; i < words.size(); ++i) {
    text += std::string(indentation + 2 * (i - first), ' ') + words[i] + ":";
    text += i + 1 == words.size() ? " " + value + "\n" : "\n";
  }
  return text;
}

std::string withNew(const SourceFile& file, const YamlNode& section, const Words& words,
                    std::size_t first, const std::string& value) {
  std::string text = file.text;
  if (first == 0) {
    if (!text.empty() && text.back() != '\n') text += '\n';
    return text + blockText(words, 0, 0, value);
  }
  const std::size_t begin = byteAt(text, section.at);
  if (text[begin] == '{') {
    const std::string rest = section.entries.empty() ? "" : ", ";
    return text.insert(begin + 1, flowText(words, first, value) + rest);
  }
  const SourcePosition& entry = section.entries.front().key_at;
  const auto indentation = static_cast<std::size_t>(entry.column) - 1;
  return text.insert(byteAt(text, {entry.file, entry.line, 1}),
                     blockText(words, first, indentation, value));
}

}  // namespace

std::string withValue(const SourceFile& file, std::string_view key, const std::string& value) {
  const YamlNode root = parseYaml(file);
  const Words words = split(key);
  const YamlNode* node = &root;
  std::size_t depth = 0;
  while (depth < words.size() && node->find(words[depth])) node = node->find(words[depth++]);
  const bool is_section =
      node->kind == YamlNode::Kind::kMap || (depth == 0 && node->kind == YamlNode::Kind::kEmpty);
  const bool is_value =
      node->kind == YamlNode::Kind::kScalar || node->kind == YamlNode::Kind::kNull;
  if (depth < words.size() && is_section) return withNew(file, *node, words, depth, value);
  if (depth < words.size() || !is_value)
    failAt(node->at, key, "cannot be written here", "expected a section, or a value");
  std::string text = file.text;
  const std::size_t begin = byteAt(text, node->at);
  return text.replace(begin, tokenLength(std::string_view(text).substr(begin)), value);
}

}  // namespace tactus
