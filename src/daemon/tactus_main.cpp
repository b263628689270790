#include <CLI/CLI.hpp>
#include <cstdio>

#include "tactus/daemon/commands.h"
#include "tactus/daemon/run_error.h"

int main(int argc, char** argv) {
  CLI::App app{"Tactile feedback control of redundant robot arms: the engineer's tool", "tactus"};
  app.require_subcommand(1);
  int exit_code = tactus::kExitDone;
  tactus::addCheckCommand(app, exit_code);
  tactus::addSimulateCommand(app, exit_code);
  tactus::addExportCommand(app, exit_code);
  tactus::addReplayCommand(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? tactus::kExitDone : tactus::kExitUsage;
  } catch (const tactus::RunError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return tactus::kExitFault;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return tactus::kExitBadInput;
  }
  return exit_code;
}
