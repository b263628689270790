#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/input_error.h"

/// Input errors that say where: `file:line:col: key: problem, expectation`, always one line.
namespace tactus {

/// A place in a user's file; line and column count from 1, columns in bytes.
struct SourcePosition {
  std::shared_ptr<const std::string> file;
  int line = 1;
  int column = 1;
};

/// Throws the LocatedError of a place. `key` is the dotted path of the value, "-" for none.
[[noreturn]] void failAt(const SourcePosition& at, std::string_view key, std::string_view problem,
                         std::string_view expectation);

/// Where what is wrong with a file, or an option, as a whole is shown: 1:1.
SourcePosition beginOf(std::string path);

/// The position of a byte of `text`.
SourcePosition positionAt(std::shared_ptr<const std::string> file, std::string_view text,
                          std::size_t offset);
/// The byte of `text` at a position that is in it, whose column counts no byte order mark.
std::size_t offsetAt(std::string_view text, const SourcePosition& at);

/// Text of a user as errors show it: in quotes, shortened, on one line.
std::string inQuotes(std::string_view user_text);

/// Replaces whatever could break a line or hide text (control characters, line and paragraph
/// separators, direction marks, bytes that are no UTF-8) by \xNN.
std::string escaped(std::string_view text);

/// Length in bytes of the UTF-8 character that `text` starts with; 0 if there is none.
std::size_t utf8CharacterLength(std::string_view text) noexcept;

/// Which of `candidates` a user most likely meant by `word`; empty if none is near.
std::string nearestWord(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace tactus
