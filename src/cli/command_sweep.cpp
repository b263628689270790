#include <signal.h>

#include <CLI/CLI.hpp>

#include "tactus/cli/commands.h"
#include "tactus/cli/sibling_program.h"

namespace tactus {
namespace {

/// Ctrl-C while Python starts would be a traceback: it waits until the program looks for it.
void holdInterrupt() {
  sigset_t interrupt;
  ::sigemptyset(&interrupt);
  ::sigaddset(&interrupt, SIGINT);
  ::sigprocmask(SIG_BLOCK, &interrupt, nullptr);
}

}  // namespace

/// Studies are Python's: their points, workers and pages need its libraries.
void addSweepCommand(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "sweep", "Run a study: a scene at many points, on all cores; write a table and a report");
  command->prefix_command();
  command->set_help_flag();  // --help is for the program, too
  command->callback([command] {
    holdInterrupt();
    becomeSibling("tactus-sweep", command->remaining());
  });
}

}  // namespace tactus
