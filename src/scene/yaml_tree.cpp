#include "tactus/scene/yaml_tree.h"

#include <fmt/format.h>

#include <charconv>

namespace tactus {
namespace {

/// One step of a dotted path: a key and the list indices behind it.
struct PathStep {
  std::string key;
  std::vector<std::size_t> indices;
};

constexpr std::size_t kMaxPathSteps = 8;

/// Empty if the path is malformed.
std::vector<PathStep> splitPath(std::string_view path) {
  std::vector<PathStep> steps;
  while (true) {
    const std::size_t dot = path.find('.');
    std::string_view word = path.substr(0, dot);
    PathStep step{std::string(word.substr(0, word.find('['))), {}};
    word.remove_prefix(step.key.size());
    if (step.key.empty()) return {};
    while (!word.empty()) {
      const std::size_t close = word.find(']');
      if (word[0] != '[' || close == std::string_view::npos) return {};
      const char* const end = word.data() + close;
      std::size_t index = 0;
      const auto [stop, error] = std::from_chars(word.data() + 1, end, index);
      if (error != std::errc() || stop != end) return {};
      step.indices.push_back(index);
      word.remove_prefix(close + 1);
    }
    steps.push_back(std::move(step));
    if (steps.size() > kMaxPathSteps) return {};
    if (dot == std::string_view::npos) return steps;
    path.remove_prefix(dot + 1);
  }
}

const YamlNode* step(const YamlNode* node, const PathStep& step) {
  node = node->find(step.key);
  for (const std::size_t index : step.indices) {
    if (!node || index >= node->items.size()) return nullptr;
    node = &node->items[index];
  }
  return node;
}

bool isNothing(const YamlNode& node) {
  return node.kind == YamlNode::Kind::kEmpty || node.kind == YamlNode::Kind::kNull;
}

/// `name` is what the node is called in the setting.
[[noreturn]] void failForIndex(const SourcePosition& at, const std::string& key,
                               const std::string& name, const YamlNode& node, std::size_t index) {
  if (node.kind == YamlNode::Kind::kList && !node.items.empty()) {
    failAt(at, key, fmt::format("there is no entry {}", index),
           fmt::format("expected an index below {}", node.items.size()));
  }
  std::string is = describe(node);
  std::string expected = "no index";
  if (isNothing(node)) {
    is = "not given";
    expected = "a key that is given as a list; `tactus keys` names those that can be";
  } else if (node.kind == YamlNode::Kind::kList) {
    is = "an empty list";
    expected = "the whole list";
  } else if (node.kind == YamlNode::Kind::kMap) {
    expected =
        node.entries.empty() ? "a key in it" : "a key in it, as " + inQuotes(node.entries[0].key);
  }
  failAt(at, key, fmt::format("there is no entry {}: {} is {}", index, inQuotes(name), is),
         "expected " + expected);
}

}  // namespace

YamlNode::YamlNode(Kind kind_, SourcePosition at_, std::string text_)
    : kind(kind_), at(std::move(at_)), text(std::move(text_)) {}

const YamlNode* YamlNode::find(std::string_view key) const {
  for (const YamlEntry& entry : entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

YamlNode* YamlNode::find(std::string_view key) {
  return const_cast<YamlNode*>(static_cast<const YamlNode*>(this)->find(key));
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kEmpty:
      return "no value";
    case YamlNode::Kind::kNull:
      return "null";
    case YamlNode::Kind::kScalar:
      return node.quoted ? "the text " + inQuotes(node.text) : inQuotes(node.text);
    case YamlNode::Kind::kList:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::kMap:
      return "a section";
  }
  return "";
}

void mergeYaml(YamlNode& base, YamlNode overlay) {
  if (base.kind != YamlNode::Kind::kMap || overlay.kind != YamlNode::Kind::kMap) {
    base = std::move(overlay);
    return;
  }
  base.at = overlay.at;
  for (YamlEntry& entry : overlay.entries) {
    if (YamlNode* inherited = base.find(entry.key)) {
      mergeYaml(*inherited, std::move(entry.value));
    } else {
      base.entries.push_back(std::move(entry));
    }
  }
}

void applyOverride(YamlNode& root, const Override& setting, std::string_view path) {
  const SourceFile source{"--set " + setting.key, setting.value};
  const SourcePosition at = beginOf(source.path);
  const std::vector<PathStep> steps = splitPath(path);
  if (steps.empty()) {
    failAt(at, setting.key, "is no path of keys", "expected section.key or section.list[0].key");
  }
  YamlNode* node = &root;
  std::string name;  // of the node
  for (const PathStep& path_step : steps) {
    if (isNothing(*node)) *node = YamlNode{YamlNode::Kind::kMap, at};
    if (node->kind == YamlNode::Kind::kList)
      failAt(at, setting.key, fmt::format("{} is looked for in a list", inQuotes(path_step.key)),
             fmt::format("expected which of its entries, such as {}[0]", name));
    if (node->kind != YamlNode::Kind::kMap) {
      failAt(at, setting.key, fmt::format("{} is no key of a section", inQuotes(path_step.key)),
             setting.key == path ? "expected a key the scene knows"
                                 : "expected a key the robot knows");
    }
    if (!node->find(path_step.key)) {
      node->entries.push_back({path_step.key, at, YamlNode{YamlNode::Kind::kEmpty, at}});
    }
    node = node->find(path_step.key);
    name = path_step.key;
    for (const std::size_t index : path_step.indices) {
      if (index >= node->items.size()) failForIndex(at, setting.key, name, *node, index);
      node = &node->items[index];
      name += fmt::format("[{}]", index);
    }
  }
  mergeYaml(*node, parseYaml(source));
}

const YamlNode* findGiven(const YamlNode& root, std::string_view path) {
  const YamlNode* node = &root;
  for (const PathStep& path_step : splitPath(path)) {
    if (node) node = step(node, path_step);
  }
  return node && node->kind != YamlNode::Kind::kNull ? node : nullptr;
}

SourcePosition locate(const YamlNode& root, std::string_view path) {
  const YamlNode* node = &root;
  for (const PathStep& path_step : splitPath(path)) {
    const YamlNode* next = step(node, path_step);
    if (!next) break;
    node = next;
  }
  return node->at;
}

}  // namespace tactus
