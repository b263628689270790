#pragma once

#include <filesystem>
#include <string>

namespace tactus {

inline constexpr const char* kNameHelp =
    "Name of the run's folder in place of the scene's, so that runs of one scene stay side by side";

/// Throws InputError, as an error of the option --name, unless it names one folder.
void checkRunName(const std::string& name);

/// Makes the folder of a run, which has the scene's name or its own, and removes what an earlier
/// run left that this one may not replace: its summary, for one that fails leaves none, and its
/// older logs. Throws InputError, as an error of the option -o.
std::filesystem::path prepareRunFolder(const std::string& directory, const std::string& name);

/// Holds a folder as long as it lives, by flock(), as systemd-tmpfiles does, which then keeps old
/// logs there.
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

/// A folder that prepareRunFolder() has prepared, and that is held. Throws InputError where another
/// run still writes, too, and leaves what is there.
class RunFolder {
 public:
  RunFolder(const std::string& directory, const std::string& name);

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  FolderHold hold_;
};

}  // namespace tactus
