#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

/// Buffered output may fail as late as here (disk full, closed pipe).
int exitCodeAfterFlush(int exit_code) {
  const bool is_flushed = std::fflush(stdout) == 0;
  if (is_flushed && std::ferror(stdout) == 0) return exit_code;
  std::fprintf(stderr, "standard output: cannot be written\n");
  return kExitFault;
}

/// CLI11 names only what is missing, a command.
void refuseUnknownCommand(const CLI::App& app, const char* word) {
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  if (word[0] == '-' || std::ranges::count(commands, word) > 0) return;
  const std::string nearest = nearestWord(word, commands);
  throw CLI::ExtrasError(
      "tactus", {nearest.empty() ? std::string(word) : std::string(word) + ", perhaps " + nearest});
}

/// One line: also where what was asked for is an object a line.
void printJsonLine(const Json& json) {
  std::fputs((json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n').c_str(), stdout);
}

/// For people on standard error, and for programs, which have asked for JSON, on standard output.
int refuse(const std::exception& error, bool as_json, int exit_code) {
  std::fprintf(stderr, "%s\n", error.what());
  if (!as_json) return exit_code;
  Json json = {{"done", false}, {"error", error.what()}};
  if (const auto* located = dynamic_cast<const LocatedError*>(&error))
    json.update({{"file", located->place.file},
                 {"line", located->place.line},
                 {"column", located->place.column},
                 {"key", located->place.key},
                 {"problem", located->place.problem},
                 {"expected", located->place.expected}});
  printJsonLine(json);
  return exit_code;
}

/// The library's text has its quotes around paths, which are a user's.
RunError fileError(const std::filesystem::filesystem_error& error) {
  const std::string path = error.path1().empty() ? "a file" : escaped(error.path1().string());
  return RunError(path + ": " + error.code().message());
}

int runCommand(int argc, char** argv) {
  CLI::App app{"Tactile feedback control of redundant robot arms: the engineer's tool", "tactus"};
  app.set_version_flag("--version", TACTUS_VERSION);
  app.require_subcommand(1);
  int exit_code = kExitDone;
  const bool as_json =
      std::any_of(argv, argv + argc, [](const char* word) { return !std::strcmp(word, "--json"); });
  addInitCommand(app, exit_code);
  addCheckCommand(app, exit_code);
  addSimulateCommand(app, exit_code);
  addExportCommand(app, exit_code);
  addContactsCommand(app, exit_code);
  addScopeCommand(app, exit_code);
  addIdentifyCommand(app, exit_code);
  addCalibrateCommand(app, exit_code);
  addReplayCommand(app, exit_code);
  addPlantCommand(app, exit_code);
  addCommissionCommand(app, exit_code);
  addWhereCommand(app, exit_code);
  addBenchCommand(app, exit_code);
  addSweepCommand(app, exit_code);
  addKeysCommand(app, exit_code);
  addDoctorCommand(app, exit_code);
  addStatusCommand(app, exit_code);
  addSetCommand(app, exit_code);
  addReloadCommand(app, exit_code);
  addUndoCommand(app, exit_code);
  addDiffCommand(app, exit_code);
  addSaveCommand(app, exit_code);
  addStreamCommand(app, exit_code);
  addMoveCommand(app, exit_code);
  addFollowCommand(app, exit_code);
  addHoldCommand(app, exit_code);
  addPanelCommand(app, exit_code);
  try {
    if (argc > 1) refuseUnknownCommand(app, argv[1]);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.exit(error) == 0) return exitCodeAfterFlush(kExitDone);
    if (as_json) printJsonLine({{"done", false}, {"error", error.what()}});
    return kExitUsage;
  } catch (const RunError& error) {
    return refuse(error, as_json, kExitFault);
  } catch (const std::filesystem::filesystem_error& error) {
    return refuse(fileError(error), as_json, kExitFault);
  } catch (const std::system_error& error) {  // of fmt::print
    std::fprintf(stderr, "standard output: %s\n", error.what());
    return kExitFault;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return refuse(error, as_json, kExitBadInput);
  }
  return exitCodeAfterFlush(exit_code);
}

}  // namespace

int tactusProgram(int argc, char** argv) {
  try {
    return runCommand(argc, argv);
  } catch (const std::bad_alloc&) {  // also while options are set up
    std::fputs("tactus: out of memory\n", stderr);
    return kExitFault;
  }
}

}  // namespace tactus
