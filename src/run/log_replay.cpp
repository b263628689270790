#include "tactus/run/log_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "tactus/record/log_parts.h"
#include "tactus/record/ulog_format.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/located_error.h"
#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

constexpr std::string_view kMissedCycles = "missed_cycles";
constexpr std::uint64_t kCyclesBetweenLooks = 1000;

/// Given the number of cycles so far, now and then.
using Looks = std::function<void(std::uint64_t cycles)>;

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
Scene loadLoggedScene(const ReplayRequest& request, const LogDescription& description) {
  const std::string& log = request.logs.front();
  std::vector<Override> overrides = description.overrides;
  const std::vector<Override> settings = parseOverrides(request.settings);
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

/// Logs of the run that are not given, the first ones of such.
struct MissingParts {
  std::string path;  ///< of the log behind them
  int first = 0, count = 0;
};

[[noreturn]] void failFor(const MissingParts& missing) {
  const int last = missing.first + missing.count - 1;
  throw MissingPartsError(
      {.file = escaped(missing.path),
       .key = kPartKey,
       .problem = missing.count == 1
                      ? fmt::format("part {} of the run, just before it, is missing", last)
                      : fmt::format("parts {} to {} of the run, just before it, are missing",
                                    missing.first, last),
       .expected = "expected all logs of the run, the oldest first; behind missing ones replay "
                   "begins where the drives have stopped the arm by themselves, which none of "
                   "these logs holds"});
}

/// A replay without a single cycle of an arm under command would say nothing, and must not look as
/// if all were well.
void refuseUnknown(const std::vector<std::string>& logs, LogContinuity continuity) {
  CycleRecord record;
  MissingParts missing;
  int next = 0;
  for (const std::string& path : logs) {
    std::ifstream in = openLog(path);
    UlogReader reader(in, path);
    const int part = logPart(reader.description(), path).part;
    if (missing.count == 0 && part > next) missing = {path, next, part - next};
    next = part + 1;
    continuity.beginPart(part);
    while (reader.next(record)) {
      if (continuity.add(record) && isCommanding(static_cast<Mode>(record.mode))) return;
    }
  }
  if (continuity.stretches().empty()) return;
  if (missing.count > 0) failFor(missing);
  const UnknownStretch& first = continuity.stretches().front();
  failAt(beginOf(logs.front()), "cycle",
         fmt::format("none with a command can be replayed: from {:.9g} s on {}", first.from_s,
                     first.reason),
         "expected a log that goes on to where the drives have stopped the arm by themselves");
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
  const auto problem = findGainProblem(recorded.gains, gainUse(scene.controller), scene.period_s);
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
  LogReplay(const ReplayRequest& request, const UlogReader& first)
      : shape_(first.description().shape),
        scene_(loadLoggedScene(request, first.description())),
        controller_(scene_.controller),
        replayer_(controller_, shape_.joints, scene_.period_s, first.has(kMissedCycles)),
        comparison_(shape_),
        set_gains_(setGains(request.settings)),
        gains_(scene_.controller.gains),
        used_(gains_) {
    refuseUnknown(request.logs,
                  LogContinuity(scene_.controller, scene_.period_s, first.has(kMissedCycles)));
    if (!request.output.empty()) csv_.emplace(request.output, shape_);
  }

  void add(UlogReader& reader, const std::string& path, const Looks& look) {
    replayer_.beginPart(logPart(reader.description(), path).part);
    const bool has_path_time = reader.has("path_time_s");
    reader.assumeGains(scene_.controller.gains);
    CycleRecord recorded;
    while (reader.next(recorded)) {
      if (!has_path_time) recorded.path_time_s = recorded.task_time_s;  // nothing waited then
      if (++cycles_ % kCyclesBetweenLooks == 0) look(cycles_);
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

  ReplayResult finish(std::vector<LogExtent> extents) {
    if (csv_) csv_->close();
    return {std::move(comparison_), replayer_.unknown(), std::move(extents)};
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

}  // namespace

bool ReplayResult::isCutOff() const { return std::ranges::any_of(extents, &LogExtent::cut_off); }

ReplayResult replayLogs(const ReplayRequest& request,
                        const std::function<void(double share)>& progress) {
  std::vector<LogExtent> extents = checkParts(request.logs);
  for (const std::string& log : request.logs)
    if (!request.output.empty()) refuseOverwriting(log, request.output);
  std::uint64_t cycles = 0;
  for (const LogExtent& extent : extents) cycles += extent.cycles;
  const auto look = [&](std::uint64_t so_far) {
    progress(static_cast<double>(so_far) / static_cast<double>(cycles));
  };
  std::optional<LogReplay> replay;
  for (const std::string& path : request.logs) {
    std::ifstream in = openLog(path);
    UlogReader reader(in, path);
    if (!replay) replay.emplace(request, reader);
    replay->add(reader, path, look);
  }
  return replay->finish(std::move(extents));
}

Json replayJson(const ReplayRequest& request, const ReplayResult& result) {
  const ReplayComparison& comparison = result.comparison;
  const auto& first = comparison.first();
  Json largest = Json::array();
  for (const ReplayDifference& difference : comparison.largest())
    largest.push_back(differenceJson(difference));
  return {{"logs", request.logs},
          {"set", request.settings},
          {"forces", "as recorded"},
          {"cycles", comparison.cycles() + comparison.skipped()},
          {"cut_off", result.isCutOff()},
          {"compared_cycles", comparison.cycles()},
          {"not_replayed", stretchesJson(result.unknown)},
          {"differing_cycles", comparison.differingCycles()},
          {"first_difference", first ? differenceJson(*first) : Json()},
          {"largest_differences", largest}};
}

}  // namespace tactus
