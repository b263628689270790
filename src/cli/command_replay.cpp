#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tactus/cli/commands.h"
#include "tactus/cli/progress_line.h"
#include "tactus/daemon/named_file.h"
#include "tactus/run/log_replay.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

struct ReplayOptions {
  ReplayRequest request;
  bool json = false;
};

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

std::string differencesText(const ReplayRequest& request, const ReplayComparison& comparison) {
  if (!comparison.first()) {
    return fmt::format("{} cycles, every output equal to the bit\n", comparison.cycles());
  }
  const ReplayDifference& first = *comparison.first();
  std::string text = fmt::format(
      "{} of {} cycles differ, first cycle {} at {:.9g} s: {} recorded {}, replayed {}\n",
      comparison.differingCycles(), comparison.cycles(), first.cycle, first.t_s, first.column,
      first.recorded, first.replayed);
  if (request.settings.empty()) return text;
  text += "forces are as recorded: they do not react to other commands\n";
  for (const ReplayDifference& largest : comparison.largest()) {
    text += fmt::format("largest difference of {}: {:.6g} at {:.9g} s, recorded {}, replayed {}\n",
                        largest.column, largest.size(), largest.t_s, largest.recorded,
                        largest.replayed);
  }
  return text;
}

int runReplay(const ReplayOptions& options) {
  const ReplayRequest& request = options.request;
  const ReplayResult result = [&] {
    ProgressLine line("replay");
    return replayLogs(request, [&](double share) { line.show(share); });
  }();
  for (std::size_t i = 0; i < result.extents.size(); ++i) {
    if (!result.extents[i].cut_off) continue;
    fmt::print(stderr, "{}: the log was cut off after {} cycles\n", escaped(request.logs[i]),
               result.extents[i].cycles);
  }
  const ReplayComparison& comparison = result.comparison;
  const std::string report = options.json
                                 ? jsonText(replayJson(request, result))
                                 : stretchesText(result) + differencesText(request, comparison);
  fmt::print(request.output == "-" ? stderr : stdout, "{}", report);
  return request.settings.empty() && comparison.first() ? kExitFault : kExitDone;
}

}  // namespace

void addReplayCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* const command =
      app.add_subcommand("replay", "Feed a log's inputs to the controller and compare its outputs");
  command
      ->add_option("log", options->request.logs,
                   "Log of a run (run.ulg), or its logs, oldest first")
      ->required();
  command
      ->add_option("--set", options->request.settings,
                   std::string(kSetHelp) +
                       "; shows what that changes of the commands, while "
                       "forces stay as they were recorded")
      ->allow_extra_args(false);
  command
      ->add_option("-o,--output", options->request.output,
                   "Write recorded and replayed commands as CSV, - for standard output")
      ->check(isNamed);
  command->add_flag("--json", options->json, "Print the comparison as JSON");
  command->callback([options, &exit_code] { exit_code = runReplay(*options); });
}

}  // namespace tactus
