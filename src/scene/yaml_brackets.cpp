#include "tactus/scene/yaml_brackets.h"

#include <fmt/format.h>

#include <cctype>
#include <string>
#include <vector>

namespace tactus {
namespace {

char closing(char bracket) { return bracket == '[' ? ']' : '}'; }

/// The brackets of the lists and maps of a text in flow style, from its beginning on.
class BracketScan {
 public:
  explicit BracketScan(std::string_view text) : text_(text) {}

  /// Up to a byte, or to the first bracket that closes another one than the last.
  void run(std::size_t end) {
    for (; at_ < end && mismatch_ == kNone; ++at_) step();
  }

  const std::vector<std::size_t>& open() const { return open_; }
  std::size_t mismatch() const { return mismatch_; }

  static constexpr std::size_t kNone = std::string_view::npos;

 private:
  void step() {
    const char c = text_[at_];
    const bool starts_word =
        at_ == 0 || std::string_view(" \t\r\n[{,").find(text_[at_ - 1]) != std::string_view::npos;
    if (c == '#' && starts_word) {
      at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
    } else if ((c == '"' || c == '\'') && starts_word) {
      skipQuoted(c);
    } else if ((c == '[' || c == '{') && (!open_.empty() || startsValue())) {
      open_.push_back(at_);
    } else if ((c == ']' || c == '}') && (!open_.empty() || startsValue())) {
      close(c);
    }
  }

  /// Outside of lists and maps, brackets inside of a text are a part of it.
  bool startsValue() const {
    std::size_t before = at_;
    while (before > 0 && text_[before - 1] == ' ') --before;
    return before == 0 || text_[before - 1] == '\n' ||
           (before < at_ && (text_[before - 1] == ':' || text_[before - 1] == '-'));
  }

  void skipQuoted(char quote) {
    for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_) {
      if (quote == '"' && text_[at_] == '\\') ++at_;
    }
  }

  void close(char c) {
    if (open_.empty() || closing(text_[open_.back()]) != c) {
      mismatch_ = at_;
    } else {
      open_.pop_back();
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<std::size_t> open_;
  std::size_t mismatch_ = kNone;
};

/// The byte at a position.
std::size_t offsetOf(std::string_view text, const SourcePosition& at) {
  std::size_t start = 0;
  for (int line = 1; line < at.line && start < text.size(); ++line) {
    start = std::min(text.find('\n', start), text.size() - 1) + 1;
  }
  return std::min(text.size(), start + static_cast<std::size_t>(at.column - 1));
}

}  // namespace

void refuseUnpairedBracket(std::string_view text, const SourcePosition& stopped_at) {
  BracketScan scan(text);
  scan.run(std::min(text.size(), offsetOf(text, stopped_at) + 1));
  const std::vector<std::size_t> open = scan.open();
  const auto position = [&](std::size_t offset) {
    return positionAt(stopped_at.file, text, offset);
  };
  if (const std::size_t wrong = scan.mismatch(); wrong != BracketScan::kNone) {
    const std::string problem = fmt::format("'{}' closes nothing", text[wrong]);
    if (open.empty()) failAt(position(wrong), "-", problem, "expected valid YAML: no such bracket");
    const SourcePosition begin = position(open.back());
    failAt(position(wrong), "-",
           fmt::format("'{}' cannot close the '{}' of line {}, column {}", text[wrong],
                       text[open.back()], begin.line, begin.column),
           fmt::format("expected valid YAML: '{}' here", closing(text[open.back()])));
  }
  scan.run(text.size());
  // One that is closed later is not at fault: rather a comma is missing.
  for (std::size_t depth = std::min(open.size(), scan.open().size()); depth-- > 0;) {
    if (open[depth] != scan.open()[depth]) continue;
    const char bracket = text[open[depth]];
    failAt(position(open[depth]), "-", fmt::format("'{}' is not closed", bracket),
           fmt::format("expected valid YAML: '{}' behind its last entry", closing(bracket)));
  }
}

}  // namespace tactus
