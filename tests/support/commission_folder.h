#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/hardware_files.h"
#include "tactus/record/output_file.h"
#include "tactus/scene/source_reader.h"

namespace tactus::test {

/// A scene and its robot on disk, to be written to.
class CommissionFolder {
 public:
  CommissionFolder() {
    std::string name =
        (std::filesystem::temp_directory_path() / "tactus-commission-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    const SceneFiles files = hardwareFiles();
    put("scene.yaml", files.scene);
    put("robot.yaml", "# a comment at the top\n" +
                          replaced(files.robot, "drives:\n", "drives:  # and one here\n"));
    put("robot.urdf", files.urdf);
  }
  ~CommissionFolder() { std::filesystem::remove_all(folder_); }

  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::string content(const char* name) const { return readFromDisk(path(name)); }
  void put(const char* name, const std::string& text) const {
    OutputFile file(path(name));
    file.append(text);
    file.close();
  }
  Scene scene() const { return loadScene(path("scene.yaml"), {}); }

 private:
  std::filesystem::path folder_;
};

}  // namespace tactus::test
