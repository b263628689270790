#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/cli/progress_line.h"
#include "tactus/record/log_parts.h"
#include "tactus/record/replay.h"
#include "tactus/record/ulog_format.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"
#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

constexpr std::string_view kMissedCycles = "missed_cycles";
constexpr std::uint64_t kCyclesBetweenLooks = 1000;

using CycleProgress = std::function<void(std::uint64_t cycles)>;

struct ReplayOptions {
  std::vector<std::string> logs, settings;
  std::string output;
  bool json = false;
};

void checkSize(const std::string& log, const char* field, const char* what, int logged,
               int of_scene) {
  if (logged == of_scene) return;
  failAt(beginOf(log), field,
         fmt::format("the cycles have {} {}, the log's scene {}", logged, what, of_scene),
         "expected the log of a run of its scene");
}

/// Its cycles came when they came.
void refusePeriod(const std::vector<Override>& settings) {
  if (std::ranges::count(settings, "period_s", &Override::key) == 0) return;
  failAt(beginOf("--set period_s"), "period_s", "cannot be set in a replay",
         "expected keys other than the period of recorded cycles");
}

/// The scene of the first log with its own overrides and then those of the command line.
Scene loadLoggedScene(const ReplayOptions& options, const LogDescription& description) {
  const std::string& log = options.logs.front();
  std::vector<Override> overrides = description.overrides;
  const std::vector<Override> settings = parseOverrides(options.settings);
  refusePeriod(settings);
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  if (description.sources.empty()) {
    failAt(beginOf(log), "source_path", "the log holds no scene", "expected the files of the run");
  }
  Scene scene = loadScene(description.sources, overrides, SceneUse::kSimulation);
  const RecordShape expected = describeLog(scene).shape;
  checkSize(log, "q", "joints", description.shape.joints, expected.joints);
  checkSize(log, "w", "task components", description.shape.task_size, expected.task_size);
  checkSize(log, "force_sensor_N", "tactile modules", description.shape.modules, expected.modules);
  return scene;
}

struct ReplayResult {
  ReplayComparison comparison;
  std::vector<UnknownStretch> unknown;  ///< that were not compared
  bool cut_off = false;                 ///< any of the logs
};

/// A replay without a single cycle of an arm under command would say nothing, and must not look as
/// if all were well.
void refuseUnknown(const std::vector<std::string>& logs, LogContinuity continuity) {
  CycleRecord record;
  for (const std::string& path : logs) {
    std::ifstream in = openLog(path);
    UlogReader reader(in, path);
    continuity.beginPart(logPart(reader.description(), path).part);
    while (reader.next(record)) {
      if (continuity.add(record) && isCommanding(static_cast<Mode>(record.mode))) return;
    }
  }
  if (continuity.stretches().empty()) return;
  const UnknownStretch& first = continuity.stretches().front();
  failAt(beginOf(logs.front()), "cycle",
         fmt::format("none with a command can be replayed: from {:.9g} s on {}", first.from_s,
                     first.reason),
         "expected all logs of the run, the oldest first");
}

/// Where in Gains those lie that --set gives, as such or with their section.
std::vector<std::size_t> setGains(const std::vector<std::string>& settings) {
  std::vector<std::size_t> offsets;
  for (const Override& setting : parseOverrides(settings)) {
    for (const GainKey& key : gainKeys()) {
      if (key.path == setting.key || key.path.starts_with(setting.key + "."))
        offsets.push_back(key.offset);
    }
  }
  return offsets;
}

void checkGains(const std::string& path, const Scene& scene, const CycleRecord& recorded) {
  const ControllerConfig& controller = scene.controller;
  const GainUse use = gainUse(controller.force_control, controller.tactile_modules.size());
  const auto problem = findGainProblem(recorded.gains, use, scene.period_s);
  if (!problem) return;
  failAt(beginOf(path), problem->path,
         fmt::format("{}, in the gains recorded at {:.9g} s", problem->problem, recorded.t_s),
         "expected " + problem->expectation);
}

void checkMotion(const std::string& path, const Scene& scene, const CycleRecord& recorded) {
  if (!scene.controller.task.commands || isValid(recorded.tool_motion)) return;
  failAt(beginOf(path), kToolMotionTopic,
         fmt::format("no motion of a tool at {:.9g} s", recorded.t_s),
         "expected finite numbers, and limits above 0");
}

/// A scene, and what becomes of it fed with logs, one after the other.
class LogReplay {
 public:
  LogReplay(const ReplayOptions& options, const UlogReader& first)
      : shape_(first.description().shape),
        scene_(loadLoggedScene(options, first.description())),
        controller_(scene_.controller),
        replayer_(controller_, shape_.joints, scene_.period_s, first.has(kMissedCycles)),
        comparison_(shape_),
        set_gains_(setGains(options.settings)),
        gains_(scene_.controller.gains),
        used_(gains_) {
    refuseUnknown(options.logs, LogContinuity(scene_.period_s, first.has(kMissedCycles),
                                              scene_.controller.has_joint_limit_avoidance));
    if (!options.output.empty()) csv_.emplace(options.output, shape_);
  }

  void add(UlogReader& reader, const std::string& path, const CycleProgress& progress) {
    replayer_.beginPart(logPart(reader.description(), path).part);
    const bool has_path_time = reader.has("path_time_s");
    reader.assumeGains(scene_.controller.gains);
    CycleRecord recorded;
    while (reader.next(recorded)) {
      if (!has_path_time) recorded.path_time_s = recorded.task_time_s;  // nothing waited then
      if (++cycles_ % kCyclesBetweenLooks == 0) progress(cycles_);
      checkMotion(path, scene_, recorded);
      tune(path, recorded);
      const CycleRecord replayed = replayer_.replay(recorded);
      if (!replayer_.isKnown()) {
        comparison_.skip();
        continue;
      }
      comparison_.add(recorded, replayed);
      if (csv_) csv_->add(recorded, replayed);
    }
  }

  ReplayResult finish() {
    if (csv_) csv_->close();
    return {std::move(comparison_), replayer_.unknown()};
  }

 private:
  /// Checks recorded gains, and lays those of --set over them.
  void tune(const std::string& path, CycleRecord& recorded) {
    if (!isSame(recorded.gains, gains_)) checkGains(path, scene_, recorded);
    gains_ = recorded.gains;
    for (const std::size_t offset : set_gains_) {
      std::memcpy(reinterpret_cast<char*>(&recorded.gains) + offset,
                  reinterpret_cast<const char*>(&scene_.controller.gains) + offset, sizeof(double));
    }
    if (!set_gains_.empty() && !isSame(recorded.gains, used_)) checkGains(path, scene_, recorded);
    used_ = recorded.gains;
  }

  RecordShape shape_;
  Scene scene_;
  Controller controller_;
  Replayer replayer_;
  ReplayComparison comparison_;
  std::vector<std::size_t> set_gains_;  ///< offsets
  Gains gains_;                         ///< of the cycle before, as recorded
  Gains used_;                          ///< and with those of --set
  std::uint64_t cycles_ = 0;
  std::optional<ReplayCsv> csv_;
};

ReplayResult replayLogs(const ReplayOptions& options, const CycleProgress& progress) {
  std::optional<LogReplay> replay;
  for (const std::string& path : options.logs) {
    std::ifstream in = openLog(path);
    UlogReader reader(in, path);
    if (!replay) replay.emplace(options, reader);
    replay->add(reader, path, progress);
  }
  return replay->finish();
}

Json differenceJson(const ReplayDifference& difference) {
  return {{"column", difference.column},
          {"cycle", difference.cycle},
          {"t_s", difference.t_s},
          {"recorded", difference.recorded},
          {"replayed", difference.replayed}};
}

Json stretchesJson(const std::vector<UnknownStretch>& stretches) {
  Json json = Json::array();
  for (const UnknownStretch& stretch : stretches) {
    json.push_back(
        {{"from_s", stretch.from_s}, {"to_s", stretch.to_s}, {"reason", stretch.reason}});
  }
  return json;
}

Json replayJson(const ReplayOptions& options, const ReplayResult& result) {
  const ReplayComparison& comparison = result.comparison;
  const auto& first = comparison.first();
  Json largest = Json::array();
  for (const ReplayDifference& difference : comparison.largest())
    largest.push_back(differenceJson(difference));
  return {{"logs", options.logs},
          {"set", options.settings},
          {"forces", "as recorded"},
          {"cycles", comparison.cycles() + comparison.skipped()},
          {"cut_off", result.cut_off},
          {"compared_cycles", comparison.cycles()},
          {"not_replayed", stretchesJson(result.unknown)},
          {"differing_cycles", comparison.differingCycles()},
          {"first_difference", first ? differenceJson(*first) : Json()},
          {"largest_differences", largest}};
}

std::string stretchesText(const ReplayResult& result) {
  std::string text;
  for (const UnknownStretch& stretch : result.unknown) {
    text += fmt::format("not replayed from {:.9g} s to {:.9g} s: {}\n", stretch.from_s,
                        stretch.to_s, stretch.reason);
  }
  const ReplayComparison& comparison = result.comparison;
  if (comparison.skipped() == 0) return text;
  return text + fmt::format("{} of {} cycles compared\n", comparison.cycles(),
                            comparison.cycles() + comparison.skipped());
}

std::string differencesText(const ReplayOptions& options, const ReplayComparison& comparison) {
  if (!comparison.first()) {
    return fmt::format("{} cycles, every output equal to the bit\n", comparison.cycles());
  }
  const ReplayDifference& first = *comparison.first();
  std::string text = fmt::format(
      "{} of {} cycles differ, first cycle {} at {:.9g} s: {} recorded {}, replayed {}\n",
      comparison.differingCycles(), comparison.cycles(), first.cycle, first.t_s, first.column,
      first.recorded, first.replayed);
  if (options.settings.empty()) return text;
  text += "forces are as recorded: they do not react to other commands\n";
  for (const ReplayDifference& largest : comparison.largest()) {
    text += fmt::format("largest difference of {}: {:.6g} at {:.9g} s, recorded {}, replayed {}\n",
                        largest.column, largest.size(), largest.t_s, largest.recorded,
                        largest.replayed);
  }
  return text;
}

int runReplay(const ReplayOptions& options) {
  const std::vector<LogExtent> extents = checkParts(options.logs);
  for (const std::string& log : options.logs) {
    if (!options.output.empty()) refuseOverwriting(log, options.output);
  }
  std::uint64_t cycles = 0;
  for (const LogExtent& extent : extents) cycles += extent.cycles;
  ReplayResult result = [&] {
    ProgressLine line("replay");
    return replayLogs(options, [&](std::uint64_t so_far) {
      line.show(static_cast<double>(so_far) / static_cast<double>(cycles));
    });
  }();
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (!extents[i].cut_off) continue;
    result.cut_off = true;
    fmt::print(stderr, "{}: the log was cut off after {} cycles\n", escaped(options.logs[i]),
               extents[i].cycles);
  }
  const ReplayComparison& comparison = result.comparison;
  const std::string report = options.json
                                 ? jsonText(replayJson(options, result))
                                 : stretchesText(result) + differencesText(options, comparison);
  fmt::print(options.output == "-" ? stderr : stdout, "{}", report);
  return options.settings.empty() && comparison.first() ? kExitFault : kExitDone;
}

}  // namespace

void addReplayCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* const command =
      app.add_subcommand("replay", "Feed a log's inputs to the controller and compare its outputs");
  command->add_option("log", options->logs, "Log of a run (run.ulg), or its logs, oldest first")
      ->required();
  command
      ->add_option("--set", options->settings,
                   std::string(kSetHelp) +
                       "; shows what that changes of the commands, while "
                       "forces stay as they were recorded")
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output,
                      "Write recorded and replayed commands as CSV, - for standard output");
  command->add_flag("--json", options->json, "Print the comparison as JSON");
  command->callback([options, &exit_code] { exit_code = runReplay(*options); });
}

}  // namespace tactus
