#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/cli/progress_line.h"
#include "tactus/record/fault_text.h"
#include "tactus/record/run_folder.h"
#include "tactus/record/run_summary.h"
#include "tactus/record/unsensed_text.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> settings;
  std::string directory;
  std::optional<std::string> name;
  bool json = false;
};

void checkName(const SimulateOptions& options) {
  if (!options.name) return;
  checkRunName(*options.name);
  if (options.scenes.size() == 1) return;
  failAt(beginOf(*options.name), "--name",
         fmt::format("one folder for {} scenes", options.scenes.size()), "expected one scene");
}

/// All scenes are loaded before the first one runs, so that bad input writes nothing.
std::vector<Scene> loadScenes(const SimulateOptions& options) {
  const std::vector<Override> overrides = parseOverrides(options.settings);
  std::vector<Scene> scenes;
  std::set<std::string> names;
  for (const std::string& path : options.scenes) {
    scenes.push_back(loadScene(path, overrides, SceneUse::kSimulation));
    if (!names.insert(scenes.back().name).second) {
      failAt(beginOf(path), "-", "a second scene named " + inQuotes(scenes.back().name),
             "expected names that differ, each names a folder");
    }
  }
  return scenes;
}

/// All folders are prepared before the first scene runs, too. Nobody else may write there until all
/// have: of two logs in one file nobody could read any.
std::deque<RunFolder> prepareFolders(const SimulateOptions& options,
                                     const std::vector<Scene>& scenes) {
  std::deque<RunFolder> folders;
  for (const Scene& scene : scenes)
    folders.emplace_back(options.directory, options.name.value_or(scene.name));
  return folders;
}

void printHeading() {
  fmt::print("{:<28} {:>9} {:>9} {:>10} {:>10} {:>8}  {}\n", "scene", "peak", "final", "TCP max",
             "TCP final", "faster", "outcome");
  fmt::print("{:<28} {:>9} {:>9} {:>10} {:>10} {:>8}\n", "", "N", "N", "mm", "mm", "than real");
}

/// name: of the run, as several may be of one scene.
void printRow(const std::string& name, const Scene& scene, const SimulationResult& result) {
  const RunFigures& figures = result.figures;
  fmt::print(
      "{:<28} {:9.3f} {:9.3f} {:10.3f} {:10.3f} {:7.0f}x  {}\n", escaped(name),
      figures.peak_force_N, figures.final_force_N, 1e3 * figures.tcp_error_max_m,
      1e3 * figures.tcp_error_final_m, result.real_time_factor,
      figures.end.fault == Fault::kNone ? "completed" : escaped(faultEvent(figures.end, scene)));
  if (figures.unsensed && figures.unsensed->force_N > 0.0)
    fmt::print("{:<28} {}\n", "", escaped(unsensedText(*figures.unsensed, scene)));
}

SimulationResult simulateScene(const Scene& scene, const fs::path& folder) {
  const SimulationResult result = [&] {
    ProgressLine line(scene.name);
    return simulate(scene, (folder / "run.ulg").string(), [&](double share) { line.show(share); });
  }();
  writeSummary((folder / "summary.json").string(), scene, result.figures, result.real_time_factor);
  return result;
}

int simulateScenes(const SimulateOptions& options) {
  checkName(options);
  const std::vector<Scene> scenes = loadScenes(options);
  const std::deque<RunFolder> folders = prepareFolders(options, scenes);
  int exit_code = kExitDone;
  if (!options.json) printHeading();
  Json json = Json::array();  // printed at the end, so that a failed run leaves no unfinished list
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const SimulationResult result = simulateScene(scenes[i], folders[i].path());
    if (result.figures.end.fault != Fault::kNone) exit_code = kExitFault;
    if (options.json) {
      json.push_back(summaryJson(scenes[i], result.figures, result.real_time_factor));
    } else {
      printRow(folders[i].path().filename().string(), scenes[i], result);
      std::fflush(stdout);
    }
  }
  if (options.json) std::fputs(jsonText(json).c_str(), stdout);
  return exit_code;
}

}  // namespace

void addSimulateCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command =
      app.add_subcommand("simulate", "Run scenes in virtual time; write a log and a summary each");
  command->add_option("SCENE", options->scenes, "Scene files")->required();
  command
      ->add_option("-o,--output", options->directory,
                   "Folder for <scene>/run.ulg and "
                   "<scene>/summary.json")
      ->required();
  command->add_option("--name", options->name, kNameHelp);
  command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print the summaries as one JSON list");
  command->callback([options, &exit_code] { exit_code = simulateScenes(*options); });
}

}  // namespace tactus
