#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/cli/plant_run.h"
#include "tactus/record/run_error.h"
#include "tactus/record/unsensed_text.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

struct PlantOptions {
  std::string scene;
  std::vector<std::string> settings;
  std::string e_stop_file;
  bool json = false;
};

Json countersJson(const PlantRunResult& result, const Scene& scene) {
  Json json = {{"stale_setpoints_applied", result.plant.stale_setpoints_applied},
               {"powers_taken_in_motion", result.plant.powers_taken_in_motion},
               {"frames_refused", result.plant.frames_refused},
               {"frames_not_taken", result.plant.frames_not_taken},
               {"interface_refused", result.interface_refused}};
  if (result.unsensed) json["unsensed_contact"] = unsensedJson(*result.unsensed, scene);
  return json;
}

void printCounters(const PlantRunResult& result, const Scene& scene) {
  fmt::print("{:<26}{}\n", "stale setpoints applied", result.plant.stale_setpoints_applied);
  fmt::print("{:<26}{}\n", "powers taken in motion", result.plant.powers_taken_in_motion);
  fmt::print("{:<26}{}\n", "frames refused by queues", result.plant.frames_refused);
  fmt::print("{:<26}{}\n", "frames not taken", result.plant.frames_not_taken);
  fmt::print("{:<26}{}\n", "refused by interfaces", result.interface_refused);
  if (result.unsensed && result.unsensed->force_N > 0.0)
    fmt::print("{}\n", escaped(unsensedText(*result.unsensed, scene)));
}

void play(const PlantOptions& options) {
  const Scene scene = loadHardwareScene(options.scene, options.settings, "to play");
  try {
    const PlantRunResult result =
        runPlant(scene, options.e_stop_file, options.json ? stderr : stdout);
    if (options.json) {
      std::fputs(jsonText(countersJson(result, scene)).c_str(), stdout);
    } else {
      printCounters(result, scene);
    }
  } catch (const std::runtime_error& error) {  // and what the operating system refuses
    throw RunError(error.what());
  }
}

}  // namespace

void addPlantCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "plant", "Play drives, tactile module and obstacles on the scene's CAN interfaces");
  const auto options = std::make_shared<PlantOptions>();
  command->add_option("SCENE", options->scene, "Scene file")->required();
  command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  command->add_option("--e-stop-file", options->e_stop_file,
                      "File or FIFO that gets 1 and 0 as the scripted e-stop moves");
  command->add_flag("--json", options->json, "Print the counters as JSON, all else to stderr");
  command->callback([options, &exit_code] {
    play(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
