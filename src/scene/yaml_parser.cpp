#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>
#include <vector>

#include "tactus/scene/yaml_brackets.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

constexpr std::size_t kMaxDepth = 16;
constexpr std::size_t kMaxKeysOfAMap = 100;  // keeps the search for duplicates cheap

bool isNullWord(std::string_view text) {
  return text == "~" || text == "null" || text == "Null" || text == "NULL";
}

/// Does a quoted text go on in the next line? As good as always somebody forgot to close it, and it
/// has swallowed the keys below.
bool isOpen(std::string_view quoted) {
  const std::string_view line = quoted.substr(0, quoted.find('\n'));
  if (!line.starts_with('"') && !line.starts_with('\'')) return false;  // text after | or >
  for (std::size_t i = 1; i < line.size(); ++i) {
    const bool is_doubled = line[0] == '\'' && line.substr(i, 2) == "''";
    if (is_doubled || (line[0] == '"' && line[i] == '\\')) {
      ++i;
    } else if (line[i] == line[0]) {
      return false;
    }
  }
  return true;
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
    const std::string_view next = rest(mark);
    const bool is_written = isNullWord(next.substr(0, next.find_first_of(" \t\r\n,]}#")));
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
    if (node.quoted && isOpen(rest(mark))) {
      failAt(node.at, path(), "a quote that is not closed in its line",
             "expected the same quote at the value's end");
    }
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
  std::string_view rest(const YAML::Mark& mark) const {
    const std::size_t uncounted = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0;  // byte order mark
    const std::size_t offset =
        mark.is_null() ? text_.size() : static_cast<std::size_t>(mark.pos) + uncounted;
    return std::string_view(text_).substr(std::min(offset, text_.size()));
  }

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

/// The first `count` lines of a text, or all.
std::vector<std::string_view> firstLines(std::string_view text, int count) {
  std::vector<std::string_view> lines;
  while (!text.empty() && count-- > 0) {
    lines.push_back(text.substr(0, text.find('\n')));
    text.remove_prefix(std::min(text.size(), lines.back().size() + 1));
  }
  return lines;
}

/// The parser stops behind these mistakes and calls them something else.
void refuseTab(std::string_view line, SourcePosition at) {
  const std::size_t tab = line.find('\t');
  if (tab == std::string_view::npos || tab > line.find_first_not_of(" \t")) return;
  at.column = static_cast<int>(tab) + 1;
  failAt(at, "-", "a tab in the indentation", "expected spaces, as in valid YAML");
}

void refuseMissingColon(std::string_view line, SourcePosition at) {
  line = line.substr(0, line.find(" #"));
  line = line.substr(0, line.find_last_not_of(" \r") + 1);
  const std::size_t start = line.find_first_not_of(' ');
  if (start == std::string_view::npos || !std::isalpha(static_cast<unsigned char>(line[start])) ||
      line.ends_with(':') || line.find(": ") != std::string_view::npos)
    return;
  at.column = static_cast<int>(start) + 1;
  failAt(at, "-", inQuotes(line.substr(start)) + " has no colon and space behind its key",
         "expected key: value, as in valid YAML");
}

bool isOneOfFlow(const std::string& problem) {
  return problem == YAML::ErrorMsg::FLOW_END || problem == YAML::ErrorMsg::END_OF_SEQ_FLOW ||
         problem == YAML::ErrorMsg::END_OF_MAP_FLOW;
}

bool isBlank(std::string_view line) {
  const std::size_t start = line.find_first_not_of(" \t\r");
  return start == std::string_view::npos || line[start] == '#';
}

const char* syntaxExpectation(const std::string& problem) {
  if (problem == YAML::ErrorMsg::MAP_VALUE)
    return "expected valid YAML: one key: value a line, keys of a section indented alike";
  if (problem == YAML::ErrorMsg::END_OF_MAP)
    return "expected valid YAML: keys of a section indented alike";
  if (problem == YAML::ErrorMsg::END_OF_SEQ)
    return "expected valid YAML: entries of a list indented alike";
  if (problem == YAML::ErrorMsg::END_OF_SEQ_FLOW) return "expected valid YAML: a comma or ]";
  if (problem == YAML::ErrorMsg::END_OF_MAP_FLOW) return "expected valid YAML: a comma or }";
  return "expected valid YAML";
}

[[noreturn]] void failSyntax(std::string_view text, const SourcePosition& at,
                             const std::string& problem) {
  std::vector<std::string_view> lines = firstLines(text, at.line);
  const auto here = [&] { return SourcePosition{at.file, static_cast<int>(lines.size()), 1}; };
  if (!lines.empty()) refuseTab(lines.back(), here());
  if (isOneOfFlow(problem)) refuseUnpairedBracket(text, at);
  if (!lines.empty() && problem == YAML::ErrorMsg::MAP_VALUE) {  // met at the colon of the next key
    do lines.pop_back();
    while (!lines.empty() && isBlank(lines.back()));
  }
  if (!lines.empty()) refuseMissingColon(lines.back(), here());
  failAt(at, "-", problem, syntaxExpectation(problem));
}

}  // namespace

YamlNode parseYaml(const SourceFile& file) {
  TreeBuilder builder(file, std::make_shared<std::string>(file.path));
  std::istringstream stream(file.text);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    // An open quote: where the last line has an end, the parser ends it there, and the builder
    // names it.
    if (error.msg == YAML::ErrorMsg::EOF_IN_SCALAR && !file.text.ends_with('\n'))
      return parseYaml({file.path, file.text + '\n'});
    failSyntax(file.text, builder.position(error.mark), error.msg);
  }
  YamlNode root = builder.takeRoot();
  if (!root.at.file) root.at = builder.position(YAML::Mark::null_mark());
  return root;
}

}  // namespace tactus
