#include <CLI/CLI.hpp>
#include <cstdio>
#include <system_error>

#include "tactus/daemon/commands.h"
#include "tactus/daemon/run_error.h"

namespace {

/// Buffered output may fail as late as here (disk full, closed pipe).
int exitCodeAfterFlush(int exit_code) {
  const bool is_flushed = std::fflush(stdout) == 0;
  if (is_flushed && std::ferror(stdout) == 0) return exit_code;
  std::fprintf(stderr, "standard output: cannot be written\n");
  return tactus::kExitFault;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Tactile feedback control of redundant robot arms: the engineer's tool", "tactus"};
  app.require_subcommand(1);
  int exit_code = tactus::kExitDone;
  tactus::addCheckCommand(app, exit_code);
  tactus::addSimulateCommand(app, exit_code);
  tactus::addExportCommand(app, exit_code);
  tactus::addReplayCommand(app, exit_code);
  tactus::addPlantCommand(app, exit_code);
  tactus::addBenchCommand(app, exit_code);
  tactus::addKeysCommand(app, exit_code);
  tactus::addDoctorCommand(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exitCodeAfterFlush(tactus::kExitDone) : tactus::kExitUsage;
  } catch (const tactus::RunError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return tactus::kExitFault;
  } catch (const std::system_error& error) {  // of fmt::print
    std::fprintf(stderr, "standard output: %s\n", error.what());
    return tactus::kExitFault;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return tactus::kExitBadInput;
  }
  return exitCodeAfterFlush(exit_code);
}
