#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "tactus/python/bindings.h"
#include "tactus/run/scene_check.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/parsed_scene.h"
#include "tactus/scene/scene_loader.h"

namespace py = pybind11;

namespace tactus {
namespace {

Scene load(const std::string& path, const std::vector<std::string>& settings) {
  return loadScene(path, parseOverrides(settings), SceneUse::kSimulation);
}

/// Of a study: from files as sources() gives them, so that a study has one state of them.
class StudyScene {
 public:
  explicit StudyScene(std::vector<SourceFile> files) : files_(std::move(files)) {}

  Scene load(const std::vector<std::string>& settings) {
    const std::lock_guard lock(mutex_);
    return files_.load(parseOverrides(settings), SceneUse::kSimulation);
  }

 private:
  ParsedScene files_;
  std::mutex mutex_;
};

std::unique_ptr<StudyScene> studyScene(
    const std::vector<std::pair<std::string, std::string>>& files) {
  if (files.empty()) throw py::value_error("no file, expected at least a scene");
  std::vector<SourceFile> sources;
  for (const auto& [path, text] : files) sources.push_back({path, text});
  return std::make_unique<StudyScene>(std::move(sources));
}

py::list sources(const Scene& scene) {
  py::list list;
  for (const SourceFile& file : scene.sources)
    list.append(py::make_tuple(py::bytes(file.path), py::bytes(file.text)));
  return list;
}

/// As for a run on hardware, from the files as they were read.
std::string check(const Scene& scene) {
  const Scene checked = loadScene(scene.sources, scene.overrides, SceneUse::kHardware);
  return jsonText(checkJson(checked, examine(checked)));
}

py::list texts(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) list.append(textOf(text));
  return list;
}

py::array_t<double> positionsArray(const JointVector& q) {
  return py::array_t<double>(q.size(), q.data());
}

py::dict gains(const Scene& scene) {
  py::dict gains;
  for (const GainKey& key : gainKeys())
    gains[key.path.c_str()] = gainAt(scene.controller.gains, key.offset);
  return gains;
}

py::dict numbers(const Scene& scene) {
  py::dict numbers;
  for (const auto& [path, number] : scene.numbers) numbers[textOf(path)] = number;
  return numbers;
}

std::vector<std::string> files(const Scene& scene) {
  std::vector<std::string> paths;
  for (const SourceFile& file : scene.sources) paths.push_back(file.path);
  return paths;
}

}  // namespace

void bindScene(py::module_& module) {
  module.def("load_scene", &load, py::arg("path"), py::arg("settings"), WithoutLock());
  module.def("study_scene", &studyScene, py::arg("files"));
  classOf<StudyScene>(module, "StudyScene", "The files of a scene, for many scenes of them.")
      .def("load", &StudyScene::load, py::arg("settings"), WithoutLock());
  classOf<Scene>(module, "Scene", "A scene with everything it names.")
      .def("check", &check, WithoutLock())
      .def("gains", &gains)
      .def("numbers", &numbers)
      .def("sources", &sources)
      .def("files", [](const Scene& scene) { return texts(files(scene)); })
      .def_property_readonly("name", [](const Scene& scene) { return textOf(scene.name); })
      .def_property_readonly("robot", [](const Scene& scene) { return textOf(scene.robot_name); })
      .def_property_readonly("variant", [](const Scene& scene) { return scene.variant; })
      .def_property_readonly("period_s", [](const Scene& scene) { return scene.period_s; })
      .def_property_readonly("duration_s", [](const Scene& scene) { return scene.duration_s; })
      .def_property_readonly("joints", [](const Scene& scene) { return texts(scene.joint_names); })
      .def_property_readonly("modules",
                             [](const Scene& scene) { return texts(scene.module_links); })
      .def_property_readonly(
          "q_start", [](const Scene& scene) { return positionsArray(scene.controller.q_start); });
}

}  // namespace tactus
