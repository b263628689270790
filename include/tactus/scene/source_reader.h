#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/located_error.h"
#include "tactus/scene/scene.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

/// Why a file could not be had, e.g. "no such file"; SourceReader adds the place.
class FileProblem : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Gives the content of a file by its path or throws FileProblem. The only way input gets in: from
/// the disk, from a log, from a fuzzer.
using FileProvider = std::function<std::string(const std::string& path)>;

inline constexpr std::size_t kMaxFileBytes = 1 << 20;

/// Throws FileProblem if there is no such file or opening it might wait.
void requireRegularFile(const std::string& path);

/// Regular files of at most kMaxFileBytes; never waits, whatever the path names.
std::string readFromDisk(const std::string& path);

/// The files of a log. Throws FileProblem for any other path.
FileProvider provideFrom(const std::vector<SourceFile>& files);

/// What was parsed of files, by their paths.
using YamlTrees = std::map<std::string, YamlNode>;

/// Reads text files and keeps every one, in the order they were asked for.
class SourceReader {
 public:
  /// `parsed`, if any, has trees of these very files, and takes those that it has not yet.
  explicit SourceReader(FileProvider provider, YamlTrees* parsed = nullptr)
      : provider_(std::move(provider)), parsed_(parsed) {}

  /// The scene, which only the command line names. Throws InputError at its first line, or at the
  /// first byte that is no UTF-8 text.
  SourceFile readFirst(const std::string& path);

  /// A file that another one names, by the value of `key` at `named_at`. Throws InputError there,
  /// or at the first byte that is no UTF-8 text.
  SourceFile read(const std::string& path, std::string_view key, const SourcePosition& named_at);

  /// The same for files whose text may be Latin-1 instead, which is kept in UTF-8.
  SourceFile readLatin(const std::string& path, std::string_view key,
                       const SourcePosition& named_at);

  /// As parseYaml().
  YamlNode parse(const SourceFile& file);

  const std::vector<SourceFile>& files() const { return files_; }

 private:
  SourceFile take(const std::string& path, std::string_view key, const SourcePosition& named_at,
                  bool may_be_latin);

  FileProvider provider_;
  YamlTrees* parsed_;
  std::vector<SourceFile> files_;
};

/// `reference` as the file `from` means it: relative to the folder of `from`, without "..".
std::string resolvePath(const std::string& from, const std::string& reference);

}  // namespace tactus
