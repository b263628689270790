#pragma once

#include <filesystem>
#include <string>

namespace tactus {

inline constexpr const char* kNameHelp =
    "Name of the run's folder in place of the scene's, so that runs of one scene stay side by side";

/// Throws InputError, as an error of the option --name, unless it names one folder.
void checkRunName(const std::string& name);

/// Holds a folder as long as it lives, by flock(), which ends with the process, however that ends,
/// and which systemd-tmpfiles heeds: it then keeps old logs there.
class FolderHold {
 public:
  explicit FolderHold(const std::string& folder) noexcept;
  ~FolderHold();
  FolderHold(const FolderHold&) = delete;
  FolderHold& operator=(const FolderHold&) = delete;

  /// Another one has it.
  bool isElsewhere() const noexcept { return is_elsewhere_; }

 private:
  int fd_;
  bool is_elsewhere_ = false;
};

/// The folder of a run, which has the scene's name or its own, made and held: also while a run that
/// waits long for its enable line writes nothing. Of an earlier run it has no more what this one
/// may not replace: its summary, for one that fails leaves none, and its older logs. Throws
/// InputError, as an error of the option -o; where another run still writes, too, and then leaves
/// what is there.
class RunFolder {
 public:
  RunFolder(const std::string& directory, const std::string& name);

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  FolderHold hold_;
};

}  // namespace tactus
