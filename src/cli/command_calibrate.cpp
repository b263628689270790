#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactus/cli/calibrate_fit.h"
#include "tactus/cli/calibrate_record.h"
#include "tactus/cli/commands.h"
#include "tactus/cli/wrench_rows.h"
#include "tactus/daemon/number_within.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

/// From live channels to the calibration of a tactile module: show, record, fit.
namespace tactus {
namespace {

struct CalibrateOptions {
  std::string what;
  std::vector<std::string> files, settings;
  std::string output;
  std::optional<std::size_t> module;
  double duration_s = 0.0;  ///< 0: until it is stopped
  bool writes = false, json = false;
};

[[noreturn]] void refuseScene(const std::string& path, const char* key, const std::string& problem,
                              const std::string& expectation) {
  failAt(beginOf(path), key, problem, "expected " + expectation);
}

/// A scene whose modules are read: one without a controller is given the one that does nothing.
Scene calibratedScene(const std::string& path, const CalibrateOptions& options, SceneUse use) {
  std::vector<Override> settings = parseOverrides(options.settings);
  Scene scene = loadScene(path, settings, use);
  if (scene.controller.tactile_modules.empty()) {
    settings.push_back({"controller.variant", "none"});
    try {
      scene = loadScene(path, settings, use);
    } catch (const LocatedError& error) {
      if (error.place.key != "controller") throw;
    }
  }
  const std::size_t modules = scene.controller.tactile_modules.size();
  if (modules == 0) refuseScene(path, "robot", "has no tactile module", "one in robot.yaml");
  const std::size_t module = options.module.value_or(0);
  if (module >= modules)
    refuseScene(path, "robot", fmt::format("there is no tactile module {}", module),
                fmt::format("--module 0 to {}", modules - 1));
  return scene;
}

/// The module on its bus, and where its frames come from.
struct LiveModule {
  SceneModule module;
  ListenedModule listened;
  FrameSource frames;
};

LiveModule liveModule(const CalibrateOptions& options) {
  const std::string& path = options.files.front();
  const Scene scene = calibratedScene(path, options, SceneUse::kHardware);
  if (!scene.hardware) refuseScene(path, "robot", "has no can section", "buses to listen to");
  const std::size_t module = options.module.value_or(0);
  const CanTactileConfig& config = scene.hardware->tactile_modules[module];
  const std::string& interface =
      scene.hardware->buses[static_cast<std::size_t>(config.bus)].interface;
  try {
    return {sceneModule(scene, module), {interface, config}, framesOf(interface, config.first_id)};
  } catch (const std::runtime_error& error) {  // what the operating system refuses
    throw RunError(error.what());
  }
}

std::vector<double> listOf(const ChannelVector& values) { return {values.begin(), values.end()}; }

Json shownJson(const LiveModule& live, const ChannelFigures& now, const Wrench5& wrench) {
  const Wrench5 noise = noiseFrom(live.module.channels, now.sigma);
  return {{"samples", now.samples},
          {"mean_counts", listOf(now.mean)},
          {"sigma_counts", listOf(now.sigma)},
          {"drift_counts_per_s", listOf(now.drift_per_s)},
          {"wrench", std::vector<double>(wrench.begin(), wrench.end())},
          {"noise", std::vector<double>(noise.begin(), noise.end())}};
}

std::string shownText(const LiveModule& live, const ChannelFigures& now, const Wrench5& wrench) {
  std::string text = channelTable(now);
  const Wrench5 noise = noiseFrom(live.module.channels, now.sigma);
  const int rows = live.module.channels.moment_x ? 5 : 4;
  for (int row = 0; row < rows; ++row)
    text += fmt::format("{} {:.3f} +- {:.3f} {}   ", kWrenchRows[row].name, wrench[row], noise[row],
                        kWrenchRows[row].unit);
  const double square = wrench.head<2>().squaredNorm();
  constexpr double kTold_N = 0.5;  // below, a place is noise
  if (square > kTold_N * kTold_N)
    text += fmt::format("at {:.3f} m", (wrench[3] * wrench[0] - wrench[2] * wrench[1]) / square);
  return text + "\n\n";
}

/// The resultant is that against the first second, as the daemon tares.
void showChannels(const CalibrateOptions& options) {
  constexpr double kShown_s = 1.0;
  const LiveModule live = liveModule(options);
  std::FILE* const notes = options.json ? stderr : stdout;
  fmt::print(notes, "{} on {}: hands off for {:g} s, which is the zero\n",
             escaped(live.module.link), escaped(live.listened.interface), kShown_s);
  std::fflush(notes);
  const ChannelFigures zero = listen(live.frames, live.listened, kShown_s).figures();
  for (double shown_s = 0.0; options.duration_s == 0.0 || shown_s < options.duration_s;
       shown_s += kShown_s) {
    const ChannelWindow window = listen(live.frames, live.listened, kShown_s);
    const ChannelFigures now = window.figures();
    const Wrench5 wrench = wrenchFrom(live.module.channels, now.mean - zero.mean);
    if (const auto defect = window.defect(&zero))
      fmt::print(
          notes, "channel {} {} {:.0f} counts\n", defect->channel,
          defect->trouble == ChannelTrouble::kAtItsEnd ? "is at its end," : "is flat-topped at",
          defect->counts);
    std::fputs(
        (options.json ? shownJson(live, now, wrench).dump() + "\n" : shownText(live, now, wrench))
            .c_str(),
        stdout);
    if (std::fflush(stdout) != 0) throw RunError("standard output: cannot be written");
  }
}

void recordFile(const CalibrateOptions& options) {
  const LiveModule live = liveModule(options);
  const auto answer = [](std::string& line) { return bool(std::getline(std::cin, line)); };
  const auto forget = [] { tcflush(STDIN_FILENO, TCIFLUSH); };  // of a terminal alone
  recordPushes({live.listened, live.module.link, live.module.shape, live.frames, answer, stdout,
                options.output, forget});
}

void fitFile(const CalibrateOptions& options) {
  const PushFile file = readPushFile(options.files.front());
  const Scene scene = calibratedScene(options.files.back(), options, SceneUse::kSimulation);
  const SceneModule module = sceneModule(scene, file);
  const CalibrationFit found = fitPushes(file, module.shape);
  const std::string written = options.writes ? writeCalibration(scene, module, file, found) : "";
  if (options.json) {
    Json json = fitJson(file, module, found);
    json["written"] = written.empty() ? Json() : Json(written);
    std::fputs(jsonText(json).c_str(), stdout);
    return;
  }
  std::fputs(fitText(file, module, found).c_str(), stdout);
  if (!written.empty()) fmt::print("{0} written, as it was is {0}~\n", escaped(written));
}

void checkWords(const CalibrateOptions& options) {
  const auto refuse = [](const char* problem) { throw CLI::ValidationError("calibrate", problem); };
  const bool fits = options.what == "fit", records = options.what == "record";
  if (options.files.size() != (fits ? 2U : 1U))
    refuse(fits ? "fit takes PUSHES.yaml and SCENE" : "expected one SCENE");
  if (records == options.output.empty())
    refuse(records ? "record needs -o PUSHES.yaml" : "-o is of record");
  if (options.writes && !fits) refuse("--write is of fit");
  if (options.module && fits)
    refuse("--module is of show and record: fit takes the one that the pushes name");
  if (options.duration_s > 0.0 && options.what != "show") refuse("--duration is of show");
  if (options.json && records) refuse("--json is of show and fit");
}

}  // namespace

void addCalibrateCommand(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("calibrate", "Calibrate a tactile module by pushes that are known");
  const auto options = std::make_shared<CalibrateOptions>();
  command
      ->add_option("what", options->what,
                   "show: live channels; record: known pushes into a file; fit: a calibration of "
                   "these. All only listen to the bus")
      ->required()
      ->check(CLI::IsMember({"show", "record", "fit"}));
  command->add_option("files", options->files, "SCENE, or for fit PUSHES.yaml SCENE")->required();
  command->add_option("-o,--output", options->output,
                      "record: file of the pushes; one that is there is continued");
  command
      ->add_option("--module", options->module,
                   "show, record: which of several tactile modules, from 0")
      ->check(CLI::Range(0, kMaxTactileModules - 1).description(""));
  command->add_option("--duration", options->duration_s, "show: seconds; else until it is stopped")
      ->check(numberWithin(1.0, 1e6));
  CLI::Option* const set =
      command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  command->add_flag("--write", options->writes, "fit: write it into robot.yaml; keeps robot.yaml~")
      ->excludes(set);
  command->add_flag("--json", options->json, "Print JSON; of show an object a line");
  command->callback([options, &exit_code] {
    checkWords(*options);
    if (options->what == "show") showChannels(*options);
    if (options->what == "record") recordFile(*options);
    if (options->what == "fit") fitFile(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
