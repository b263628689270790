#include <CLI/CLI.hpp>

#include "tactus/cli/commands.h"
#include "tactus/cli/sibling_program.h"

namespace tactus {

/// A program of its own, so that this one listens to nobody.
void addPanelCommand(CLI::App& app, int&) {
  CLI::App* command = app.add_subcommand(
      "panel", "Show the running daemon in a browser, and change its gains there");
  command->prefix_command();
  command->set_help_flag();  // --help is for the program, too
  command->callback([command] { becomeSibling("tactus-panel", command->remaining()); });
}

}  // namespace tactus
