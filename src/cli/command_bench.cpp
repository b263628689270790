#include <CLI/CLI.hpp>

#include "tactus/cli/commands.h"
#include "tactus/cli/sibling_program.h"

namespace tactus {

/// Benchmarks compare with other libraries, which nobody should need to simulate.
void addBenchCommand(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure error against run time; write tables and a report");
  command->prefix_command();
  command->set_help_flag();  // --help is for the program, too
  command->callback([command] { becomeSibling("tactus-bench", command->remaining()); });
}

}  // namespace tactus
