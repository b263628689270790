#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactus/daemon/control_client.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/daemon_program.h"
#include "tactus/daemon/daemon_run.h"
#include "tactus/daemon/measured_start.h"
#include "tactus/daemon/named_file.h"
#include "tactus/daemon/number_within.h"
#include "tactus/record/log_size.h"
#include "tactus/record/message.h"
#include "tactus/record/run_folder.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/exit_code.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

struct DaemonArguments {
  std::string scene, folder;
  std::vector<std::string> settings;
  std::optional<std::string> name;
  double duration_s = 0.0;
};

/// A start of the command line is taken instead of one that is measured.
bool readsStart(const Scene& scene) {
  const bool is_given = std::ranges::any_of(scene.overrides, [](const Override& it) {
    return it.key == "start" || it.key.starts_with("start[");
  });
  return startsMeasured(scene) && !is_given;
}

/// Where the arm is found stands in the log's settings, so that a replay begins there, too.
Scene loadRunningScene(const DaemonArguments& options) {
  constexpr const char* kPurpose = "to run on";
  Scene scene = loadHardwareScene(options.scene, options.settings, kPurpose);
  checkMeasuredStart(scene);
  if (hasEnableLine(scene)) say("waits until the enable line was off and is on");
  if (!readsStart(scene)) return scene;
  const std::string start = startText(startAt(scene, readJoints(scene)));
  say("the arm is at start: {}", start);
  std::vector<std::string> settings = options.settings;
  settings.push_back("start=" + start);
  return loadHardwareScene(options.scene, settings, kPurpose);
}

int runScene(const DaemonArguments& options) {
  if (options.name && options.folder.empty()) throw CLI::RequiresError("--name", "--output");
  if (options.name) checkRunName(*options.name);
  const Scene scene = loadRunningScene(options);
  checkStability(scene);
  checkLogSize(scene);
  DaemonOptions run;
  run.duration_s = options.duration_s;
  run.folder = options.folder;
  run.name = options.name.value_or(scene.name);
  const Fault fault = runDaemon(scene, run);
  return fault == Fault::kNone ? kExitDone : kExitFault;
}

/// Returns when the gains of the scene file are there, or wait for a moment without contact. With
/// T above some seconds their ramp takes longer than systemd waits, TimeoutStartSec= of the
/// service, and what was accepted would look as if it had failed.
int reload() {
  constexpr double kPatience_s = 15.0;
  const Json answer = ControlClient(controlPath()).change({{"do", "reload"}}, false, kPatience_s);
  const Json& state = answer.at("state");
  if (state == "ramping" || state == "going_back")
    std::fputs("tactusd: the gains are still on their way, `tactus diff` and the journal tell\n",
               stderr);
  return answer.at("trouble").get<std::string>().empty() ? kExitDone : kExitFault;
}

int runArguments(int argc, char** argv) {
  DaemonArguments options;
  CLI::App app{"Tactile feedback control of redundant robot arms: the daemon", "tactusd"};
  app.set_version_flag("--version", TACTUS_VERSION);
  bool reloads = false;
  auto* const scene = app.add_option("SCENE", options.scene, "Scene file");
  auto* const reload_flag =
      app.add_flag("--reload", reloads,
                   "Let the daemon that runs take the gains of its scene file anew, and end")
          ->excludes(scene);
  app.add_option("-o,--output", options.folder,
                 "Folder for <scene>/run.ulg and <scene>/summary.json; without it no files")
      ->check(isNamed)
      ->excludes(reload_flag);
  app.add_option("--name", options.name, kNameHelp)->excludes(reload_flag);
  app.add_option("--duration", options.duration_s, "End after so many seconds of motion")
      ->check(numberWithin(1e-3, 1e9))
      ->excludes(reload_flag);
  app.add_option("--set", options.settings, kSetHelp)
      ->allow_extra_args(false)
      ->excludes(reload_flag);
  try {
    app.parse(argc, argv);
    if (reloads) return reload();
    if (options.scene.empty()) throw CLI::RequiredError("SCENE");
    return runScene(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitUsage;
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kExitBadInput;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tactusd: %s\n", error.what());
    return kExitFault;
  }
}

}  // namespace

int tactusdProgram(int argc, char** argv) {
  try {
    return runArguments(argc, argv);
  } catch (const std::bad_alloc&) {  // also while options are set up
    std::fputs("tactusd: out of memory\n", stderr);
    return kExitFault;
  }
}

}  // namespace tactus
