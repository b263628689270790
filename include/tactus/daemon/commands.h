#pragma once

namespace CLI {
class App;
}

namespace tactus {

/// Exit codes of all programs.
enum ExitCode { kExitDone = 0, kExitBadInput = 1, kExitUsage = 2, kExitFault = 3 };

/// Of the option --set, wherever it is.
inline constexpr const char* kSetHelp =
    "Replace a value, as in --set controller.damping=0.7; may be given several times";

/// Each adds one subcommand of `tactus`. A command that was run leaves its exit code in
/// `exit_code`; bad input leaves as an InputError, which main() prints.
void addCheckCommand(CLI::App& app, int& exit_code);
void addSimulateCommand(CLI::App& app, int& exit_code);
void addExportCommand(CLI::App& app, int& exit_code);
void addReplayCommand(CLI::App& app, int& exit_code);
void addPlantCommand(CLI::App& app, int& exit_code);
void addBenchCommand(CLI::App& app, int& exit_code);
void addKeysCommand(CLI::App& app, int& exit_code);
void addDoctorCommand(CLI::App& app, int& exit_code);
void addStatusCommand(CLI::App& app, int& exit_code);

}  // namespace tactus
