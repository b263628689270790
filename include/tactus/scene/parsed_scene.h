#pragma once

#include <vector>

#include "tactus/scene/scene_loader.h"
#include "tactus/scene/source_reader.h"

namespace tactus {

/// The files of a scene, each parsed once for all scenes that overrides make of it: four fifths of
/// what loading takes.
class ParsedScene {
 public:
  /// As Scene::sources holds them; the first one is the scene.
  explicit ParsedScene(std::vector<SourceFile> files);

  /// As loadScene() of the same files, errors included. By one thread at a time.
  Scene load(const std::vector<Override>& overrides, SceneUse use);

 private:
  std::vector<SourceFile> files_;
  YamlTrees trees_;
};

}  // namespace tactus
