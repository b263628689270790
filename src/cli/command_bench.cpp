#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

/// Benchmarks compare with other libraries, which nobody should need to simulate: so they are a
/// program of their own beside this one, which takes over.
[[noreturn]] void becomeBench(const std::vector<std::string>& arguments) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "tactus-bench";
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  throw RunError(program.string() + ": cannot be run (" + std::generic_category().message(errno) +
                 "), expected the benchmarks' program beside tactus; the build makes both");
}

}  // namespace

void addBenchCommand(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure error against run time; write tables and a report");
  command->prefix_command();
  command->set_help_flag();  // --help is for the program, too
  command->callback([command] { becomeBench(command->remaining()); });
}

}  // namespace tactus
