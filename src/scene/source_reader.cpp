#include "tactus/scene/source_reader.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSizeProblem = "is larger than 1 MiB";

void checkIsText(const SourceFile& file, std::string_view key) {
  const std::string_view text = file.text;
  std::size_t offset = 0;
  while (offset < text.size()) {
    const std::size_t length = utf8CharacterLength(text.substr(offset));
    if (length == 0 || text[offset] == '\0') {
      failAt(positionAt(std::make_shared<std::string>(file.path), text, offset), key,
             fmt::format("byte 0x{:02x} is no text", static_cast<unsigned char>(text[offset])),
             "expected a text file in UTF-8");
    }
    offset += length;
  }
}

bool isUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8CharacterLength(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// Throws FileProblem where that makes it too long.
std::string utf8OfLatin(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) result += static_cast<char>(0xC0 | byte >> 6);
    result += static_cast<char>(byte >= 0x80 ? 0x80 | (byte & 0x3F) : byte);
  }
  if (result.size() > kMaxFileBytes) throw FileProblem(kSizeProblem);
  return result;
}

}  // namespace

void requireRegularFile(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw FileProblem(error ? error.message() : std::string("no such file"));
  }
  if (fs::is_directory(status)) throw FileProblem("is a folder");
  // Opening a fifo would wait for its writer.
  if (!fs::is_regular_file(status)) throw FileProblem("is no regular file");
}

std::string readFromDisk(const std::string& path) {
  requireRegularFile(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileProblem(std::string("cannot be opened: ") + std::strerror(errno));
  std::string text(kMaxFileBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) throw FileProblem(std::string("cannot be read: ") + std::strerror(errno));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxFileBytes) throw FileProblem(kSizeProblem);
  return text;
}

FileProvider provideFrom(const std::vector<SourceFile>& files) {
  return [files](const std::string& path) {
    for (const SourceFile& file : files) {
      if (file.path != path) continue;
      if (file.text.size() > kMaxFileBytes) throw FileProblem(kSizeProblem);
      return file.text;
    }
    throw FileProblem("is not among the recorded files");
  };
}

SourceFile SourceReader::readFirst(const std::string& path) {
  return read(path, "-", beginOf(path));
}

SourceFile SourceReader::read(const std::string& path, std::string_view key,
                              const SourcePosition& named_at) {
  return take(path, key, named_at, false);
}

SourceFile SourceReader::readLatin(const std::string& path, std::string_view key,
                                   const SourcePosition& named_at) {
  return take(path, key, named_at, true);
}

SourceFile SourceReader::take(const std::string& path, std::string_view key,
                              const SourcePosition& named_at, bool may_be_latin) {
  try {
    SourceFile file{path, provider_(path)};
    if (may_be_latin && !isUtf8(file.text)) file.text = utf8OfLatin(file.text);
    checkIsText(file, key);
    files_.push_back(file);
    return file;
  } catch (const FileProblem& problem) {
    const bool is_named = *named_at.file != path;
    failAt(named_at, key, (is_named ? escaped(path) + ": " : "") + problem.what(),
           key == "robot" ? "expected the path of a robot.yaml, readable, at most 1 MiB"
                          : "expected a readable file of at most 1 MiB");
  }
}

YamlNode SourceReader::parse(const SourceFile& file) {
  if (!parsed_) return parseYaml(file);
  const auto found = parsed_->find(file.path);
  if (found != parsed_->end()) return found->second;
  return parsed_->emplace(file.path, parseYaml(file)).first->second;
}

std::string resolvePath(const std::string& from, const std::string& reference) {
  return (fs::path(from).parent_path() / reference).lexically_normal().string();
}

}  // namespace tactus
