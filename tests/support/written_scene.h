#pragma once

#include <fmt/format.h>

#include <fstream>
#include <string>

#include "support/run_folder.h"
#include "tactus/scene/source_hash.h"

namespace tactus::test {

/// A scene file that is written again and again, each time with another gain.
class WrittenScene {
 public:
  explicit WrittenScene(double damping) { write(damping); }

  std::string path() const { return folder_.path() + "/scene.yaml"; }
  std::string text() const { return folder_.content("scene.yaml"); }

  void write(double damping) {
    std::ofstream(path()) << fmt::format("extends: {}/config/scenes/scenario2_tactus.yaml\n",
                                         TACTUS_SOURCE_DIR)
                          << fmt::format("controller:\n  damping: {}\n", damping);
  }
  /// As an answer of the daemon has it.
  std::string hash() const { return fmt::format("{:016x}", sourceHash(text())); }

  const RunFolder& folder() const { return folder_; }

 private:
  const RunFolder folder_;
};

}  // namespace tactus::test
