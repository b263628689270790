#include "tactus/scene/yaml_edit.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

using Words = std::vector<std::string>;

/// "a.b[2].c" is a, b, [2], c.
Words split(std::string_view key) {
  Words words;
  while (!key.empty()) {
    const std::size_t end = std::min(key.find_first_of(".[", 1), key.size());
    words.emplace_back(key.substr(0, end));
    key.remove_prefix(std::min(end + (key.substr(end, 1) == "." ? 1 : 0), key.size()));
  }
  return words;
}

/// Null if there is none.
const YamlNode* child(const YamlNode& node, const std::string& word) {
  if (word[0] != '[') return node.find(word);
  const std::string digits = word.substr(1, word.find(']') - 1);
  std::size_t index = node.items.size();
  std::from_chars(digits.data(), digits.data() + digits.size(), index);
  return index < node.items.size() ? &node.items[index] : nullptr;
}

/// Of the scalar that begins there.
std::size_t tokenLength(std::string_view text) {
  const char quote = text.empty() ? '\0' : text[0];
  if (quote == '"' || quote == '\'') {
    std::size_t end = 1;
    while (end < text.size() && text[end] != quote) end += text[end] == '\\' ? 2 : 1;
    return std::min(end + 1, text.size());
  }
  return std::min(text.find_first_of(" \t\r\n,}]#"), text.size());
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

/// That of the first line.
std::string lineEnd(const std::string& text) {
  const std::size_t end = text.find('\n');
  return end != std::string::npos && end > 0 && text[end - 1] == '\r' ? "\r\n" : "\n";
}

/// "a:\n  b: value\n", as deep as `indentation`; line_end in place of \n.
std::string blockText(const Words& words, std::size_t first, std::size_t indentation,
                      const std::string& value, const std::string& line_end) {
  std::string text;
  for (std::size_t i = first; i < words.size(); ++i) {
    text += std::string(indentation + 2 * (i - first), ' ') + words[i] + ":";
    if (i + 1 == words.size()) text += " " + value;
    text += line_end;
  }
  return text;
}

std::string withNew(const SourceFile& file, const YamlNode& section, const Words& words,
                    std::size_t first, const std::string& value) {
  std::string text = file.text;
  const std::string line_end = lineEnd(text);
  if (first == 0) {
    if (!text.empty() && text.back() != '\n') text += line_end;
    return text + blockText(words, 0, 0, value, line_end);
  }
  const std::size_t begin = offsetAt(text, section.at);
  if (text[begin] == '{') {
    const std::string rest = section.entries.empty() ? "" : ", ";
    return text.insert(begin + 1, flowText(words, first, value) + rest);
  }
  SourcePosition entry = section.entries.front().key_at;
  const auto indentation = static_cast<std::size_t>(entry.column) - 1;
  const bool follows_dash =
      text.substr(offsetAt(text, {entry.file, entry.line, 1}), indentation).find('-') !=
      std::string::npos;
  const YamlNode::Kind kind = section.entries.front().value.kind;
  if (follows_dash && kind != YamlNode::Kind::kScalar)
    failAt(section.at, words[first], "cannot be written here",
           "expected an entry that begins with a plain value");
  if (follows_dash) ++entry.line;
  if (follows_dash && text.back() != '\n') text += line_end;
  return text.insert(offsetAt(text, {entry.file, entry.line, 1}),
                     blockText(words, first, indentation, value, line_end));
}

}  // namespace

std::string withValue(const SourceFile& file, std::string_view key, const std::string& value) {
  const YamlNode root = parseYaml(file);
  const Words words = split(key);
  const YamlNode* node = &root;
  std::size_t depth = 0;
  while (depth < words.size() && child(*node, words[depth])) node = child(*node, words[depth++]);
  const bool wants_item = std::any_of(words.begin() + static_cast<std::ptrdiff_t>(depth),
                                      words.end(), [](const auto& word) { return word[0] == '['; });
  if (wants_item) failAt(node->at, key, "has no such entry", "expected one that is there");
  const bool is_section =
      node->kind == YamlNode::Kind::kMap || (depth == 0 && node->kind == YamlNode::Kind::kEmpty);
  const bool is_value =
      node->kind == YamlNode::Kind::kScalar || node->kind == YamlNode::Kind::kNull;
  if (depth < words.size() && is_section) return withNew(file, *node, words, depth, value);
  if (depth < words.size() || !is_value)
    failAt(node->at, key, "cannot be written here", "expected a section, or a value");
  std::string text = file.text;
  const std::size_t begin = offsetAt(text, node->at);
  return text.replace(begin, tokenLength(std::string_view(text).substr(begin)), value);
}

}  // namespace tactus
