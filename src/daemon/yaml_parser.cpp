#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <sstream>

#include "tactus/daemon/yaml_tree.h"

namespace tactus {
namespace {

constexpr std::size_t kMaxDepth = 16;
constexpr std::size_t kMaxKeysOfAMap = 100;  // keeps the search for duplicates cheap

bool isNullWord(std::string_view text) {
  return text == "~" || text == "null" || text == "Null" || text == "NULL";
}

/// Builds the tree out of the parser's events; maps and lists still open are on a stack.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const SourceFile& file, std::shared_ptr<const std::string> file_name)
      : text_(file.text), file_name_(std::move(file_name)) {}

  YamlNode takeRoot() { return std::move(root_); }

  SourcePosition position(const YAML::Mark& mark) const {
    if (mark.is_null()) return {file_name_, 1, 1};
    return {file_name_, mark.line + 1, mark.column + 1};
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) failAt(position(mark), "-", "a second document", "expected one document");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    rejectExtras(mark, "", anchor);
    // The parser reports a missing value and a written `~` alike; the former at the next token.
    const std::size_t offset = mark.is_null() ? text_.size() : static_cast<std::size_t>(mark.pos);
    const std::string_view rest = std::string_view(text_).substr(std::min(offset, text_.size()));
    const bool is_written = isNullWord(rest.substr(0, rest.find_first_of(" \t\r\n,]}#")));
    YamlNode node{is_written ? YamlNode::Kind::kNull : YamlNode::Kind::kEmpty, position(mark)};
    if (!is_written && !open_.empty() && open_.back().key) node.at = open_.back().key->at;
    attach(std::move(node));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    failAt(position(mark), path(), "an alias", "expected the value itself");
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    rejectExtras(mark, tag, anchor);
    YamlNode node{YamlNode::Kind::kScalar, position(mark), value};
    node.quoted = tag == "!";
    attach(std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kList);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { close(); }

 private:
  struct OpenNode {
    YamlNode node;
    std::optional<YamlNode> key;  ///< of a map: the key whose value comes next
  };

  void rejectExtras(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) const {
    if (anchor != 0) failAt(position(mark), path(), "an anchor", "expected a value without anchor");
    if (!tag.empty() && tag != "?" && tag != "!") {
      failAt(position(mark), path(), "the tag " + inQuotes(tag), "expected a value without tag");
    }
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            YamlNode::Kind kind) {
    rejectExtras(mark, tag, anchor);
    if (open_.size() >= kMaxDepth) {
      failAt(position(mark), path(), "nested too deeply",
             fmt::format("expected at most {} levels", kMaxDepth));
    }
    open_.push_back({YamlNode{kind, position(mark)}, std::nullopt});
  }

  void close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    attach(std::move(node));
  }

  void attach(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    OpenNode& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::kList) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.key) {
      takeKey(std::move(node));
    } else {
      parent.node.entries.push_back({parent.key->text, parent.key->at, std::move(node)});
      parent.key.reset();
    }
  }

  void takeKey(YamlNode key) {
    OpenNode& map = open_.back();
    if (key.kind != YamlNode::Kind::kScalar) {
      failAt(key.at, path(), describe(key) + " as a key", "expected a word");
    }
    if (const YamlNode* first = map.node.find(key.text)) {
      map.key = key;
      failAt(key.at, path(), fmt::format("given twice (first in line {})", first->at.line),
             "expected once");
    }
    if (map.node.entries.size() >= kMaxKeysOfAMap) {
      failAt(key.at, path(), "too many keys", fmt::format("expected at most {}", kMaxKeysOfAMap));
    }
    map.key = std::move(key);
  }

  /// Dotted path of the value that comes next.
  std::string path() const {
    std::string result;
    for (const OpenNode& level : open_) {
      if (level.node.kind == YamlNode::Kind::kList) {
        result += fmt::format("[{}]", level.node.items.size());
      } else if (level.key) {
        result += (result.empty() ? "" : ".") + level.key->text;
      }
    }
    return result.empty() ? "-" : result;
  }

  const std::string& text_;
  std::shared_ptr<const std::string> file_name_;
  std::vector<OpenNode> open_;
  YamlNode root_;
  int documents_ = 0;
};

}  // namespace

YamlNode parseYaml(const SourceFile& file) {
  TreeBuilder builder(file, std::make_shared<std::string>(file.path));
  std::istringstream stream(file.text);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    failAt(builder.position(error.mark), "-", error.msg, "expected valid YAML");
  }
  YamlNode root = builder.takeRoot();
  if (!root.at.file) root.at = builder.position(YAML::Mark::null_mark());
  return root;
}

}  // namespace tactus
