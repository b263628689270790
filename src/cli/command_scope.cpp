#include <CLI/CLI.hpp>
#include <memory>

#include "tactus/cli/commands.h"
#include "tactus/cli/scope_run.h"
#include "tactus/daemon/named_file.h"
#include "tactus/daemon/number_within.h"
#include "tactus/scene/exit_code.h"

/// An oscilloscope for contacts.
namespace tactus {

void addScopeCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ScopeOptions>();
  CLI::App* const command =
      app.add_subcommand("scope", "Show contacts over each other, as an oscilloscope does");
  command
      ->add_option("log", options->log, "Log of a run (run.ulg); else that of the daemon that runs")
      ->check(isNamed);
  command->add_option("--trigger", options->trigger,
                      "FIELD > NUMBER, also < >= <=, as 'force_N[0] > 1.2'; else force of any "
                      "module above F_th");
  command->add_option("--pre", options->pre_s, "Seconds before the trigger")
      ->check(numberWithin(0.0, 5.0))
      ->capture_default_str();
  command->add_option("--post", options->post_s, "Seconds behind the trigger")
      ->check(numberWithin(0.05, 20.0))
      ->capture_default_str();
  command
      ->add_option("--hysteresis", options->hysteresis,
                   "How far the field has to go back behind the level before the next trigger")
      ->check(numberWithin(0.0, 1e9));
  command
      ->add_option("--holdoff", options->holdoff_s,
                   "Seconds without another trigger; --post at least")
      ->check(numberWithin(0.0, 1e6));
  CLI::Option* const single =
      command->add_flag("--single", options->is_single, "End after the first trigger");
  CLI::Option* const normal =
      command->add_flag("--normal")->description("Show each trigger (default)");
  CLI::Option* const automatic = command->add_flag(
      "--auto", options->is_auto, "Show also what there is where no trigger comes");
  single->excludes(normal)->excludes(automatic);
  normal->excludes(automatic);
  command->add_option("--keep", options->keep, "How many of the last ones are shown")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "HTML file to write")->check(isNamed);
  command->add_flag("--follow", options->follows, "Go on with what comes, until the run ends");
  command->add_flag("--json", options->json, "Print JSON; with --follow an object a line");
  command->callback([options, &exit_code] {
    exit_code = kExitDone;
    runScope(*options);
  });
}

}  // namespace tactus
