#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "tactus/cli/commands.h"
#include "tactus/run/clearance_check.h"
#include "tactus/run/scene_check.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/urdf_capsules.h"

namespace tactus {
namespace {

struct CheckOptions {
  std::string scene;
  std::vector<std::string> settings;
  bool json = false;
  bool capsules = false;
};

void runCheck(const CheckOptions& options) {
  std::vector<Override> settings = parseOverrides(options.settings);
  // Whose section needs them before the scene loads.
  if (options.capsules) settings.push_back({"clearance", "~"});
  const Scene scene = loadScene(options.scene, settings);
  if (options.capsules) {
    const std::string proposed = proposeCapsules(scene);
    std::fputs((proposed + touchingCapsules(scene, proposed)).c_str(), stdout);
    return;
  }
  const Findings findings = examine(scene);
  const std::string report =
      options.json ? jsonText(checkJson(scene, findings)) : checkText(scene, findings);
  std::fputs(report.c_str(), stdout);
}

}  // namespace

void addCheckCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("check", "Validate a scene and show what it consists of");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("scene", options->scene, "Scene file")->required();
  command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  CLI::Option* const json = command->add_flag("--json", options->json, "Print JSON");
  command
      ->add_flag("--capsules", options->capsules,
                 "Print collision_capsules for robot.yaml instead, from the URDF's geometry")
      ->excludes(json);
  command->callback([options, &exit_code] {
    runCheck(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
