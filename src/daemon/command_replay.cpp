#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactus/daemon/command_scene.h"
#include "tactus/daemon/commands.h"
#include "tactus/daemon/json.h"
#include "tactus/daemon/located_error.h"
#include "tactus/daemon/replay.h"
#include "tactus/daemon/ulog_reader.h"

namespace tactus {
namespace {

struct ReplayOptions {
  std::string log, output;
  std::vector<std::string> settings;
  bool json = false;
};

void checkSize(const std::string& log, const char* field, const char* what, int logged,
               int of_scene) {
  if (logged == of_scene) return;
  failAt({std::make_shared<std::string>(log), 1, 1}, field,
         fmt::format("the cycles have {} {}, the log's scene {}", logged, what, of_scene),
         "expected the log of a run of its scene");
}

/// The scene of the log with its own overrides and then those of the command line.
Scene loadLoggedScene(const ReplayOptions& options, const LogDescription& description) {
  std::vector<Override> overrides = description.overrides;
  for (const Override& setting : parseOverrides(options.settings)) overrides.push_back(setting);
  if (description.sources.empty()) {
    failAt({std::make_shared<std::string>(options.log), 1, 1}, "source_path",
           "the log holds no scene", "expected the files of the run");
  }
  Scene scene = loadScene(description.sources, overrides, SceneUse::kSimulation);
  checkSize(options.log, "q", "joints", description.shape.joints, scene.controller.chain.size());
  checkSize(options.log, "w", "task components", description.shape.task_size,
            scene.controller.task.size);
  return scene;
}

ReplayComparison replayLog(const ReplayOptions& options, UlogReader& reader) {
  const RecordShape& shape = reader.description().shape;
  const Scene scene = loadLoggedScene(options, reader.description());
  const Controller controller(scene.controller);
  Replayer replayer(controller, shape.joints, scene.period_s);
  ReplayComparison comparison(shape);
  std::optional<ReplayCsv> csv;
  if (!options.output.empty()) csv.emplace(options.output, shape);
  CycleRecord recorded;
  while (reader.next(recorded)) {
    const CycleRecord replayed = replayer.replay(recorded);
    comparison.add(recorded, replayed);
    if (csv) csv->add(recorded, replayed);
  }
  if (csv) csv->close();
  return comparison;
}

void writeDifference(const ReplayDifference& difference, JsonWriter& json) {
  json.beginObject();
  json.key("column").value(difference.column);
  json.key("cycle").value(difference.cycle);
  json.key("t_s").value(difference.t_s);
  json.key("recorded").value(difference.recorded);
  json.key("replayed").value(difference.replayed);
  json.endObject();
}

std::string jsonReport(const ReplayOptions& options, const ReplayComparison& comparison,
                       bool cut_off) {
  JsonWriter json;
  json.beginObject();
  json.key("log").value(options.log);
  json.key("set").beginArray();
  for (const std::string& setting : options.settings) json.value(setting);
  json.endArray();
  json.key("cycles").value(comparison.cycles());
  json.key("cut_off").value(cut_off);
  json.key("differing_cycles").value(comparison.differingCycles());
  json.key("first_difference");
  if (comparison.first()) {
    writeDifference(*comparison.first(), json);
  } else {
    json.null();
  }
  json.key("largest_differences").beginArray();
  for (const ReplayDifference& largest : comparison.largest()) writeDifference(largest, json);
  json.endArray();
  json.endObject();
  return json.text();
}

std::string textReport(const ReplayOptions& options, const ReplayComparison& comparison) {
  if (!comparison.first()) {
    return fmt::format("{} cycles, every output equal to the bit\n", comparison.cycles());
  }
  const ReplayDifference& first = *comparison.first();
  std::string text = fmt::format(
      "{} of {} cycles differ, first cycle {} at {:.9g} s: {} recorded {}, replayed {}\n",
      comparison.differingCycles(), comparison.cycles(), first.cycle, first.t_s, first.column,
      first.recorded, first.replayed);
  if (options.settings.empty()) return text;
  for (const ReplayDifference& largest : comparison.largest()) {
    text += fmt::format("largest difference of {}: {:.6g} at {:.9g} s, recorded {}, replayed {}\n",
                        largest.column, largest.size(), largest.t_s, largest.recorded,
                        largest.replayed);
  }
  return text;
}

int runReplay(const ReplayOptions& options) {
  const LogExtent extent = checkLog(options.log);
  if (!options.output.empty()) refuseOverwriting(options.log, options.output);
  std::ifstream in = openLog(options.log);
  UlogReader reader(in, options.log);
  const ReplayComparison comparison = replayLog(options, reader);
  if (extent.cut_off)
    fmt::print(stderr, "{}: the log was cut off after {} cycles\n", escaped(options.log),
               extent.cycles);
  const std::string report = options.json ? jsonReport(options, comparison, extent.cut_off)
                                          : textReport(options, comparison);
  fmt::print(options.output == "-" ? stderr : stdout, "{}", report);
  return options.settings.empty() && comparison.first() ? kExitFault : kExitDone;
}

}  // namespace

void addReplayCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* const command =
      app.add_subcommand("replay", "Feed a log's inputs to the controller and compare its outputs");
  command->add_option("log", options->log, "Log of a run (run.ulg)")->required();
  command
      ->add_option("--set", options->settings, std::string(kSetHelp) + "; shows what that changes")
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output,
                      "Write recorded and replayed commands as CSV, - for standard output");
  command->add_flag("--json", options->json, "Print the comparison as JSON");
  command->callback([options, &exit_code] { exit_code = runReplay(*options); });
}

}  // namespace tactus
