#pragma once

#include "tactus/scene/exit_code.h"

namespace CLI {
class App;
}

namespace tactus {

/// What main() of tactus does, from its arguments to its exit code.
int tactusProgram(int argc, char** argv);

/// Each adds one subcommand of `tactus`. A command that was run leaves its exit code in
/// `exit_code`; bad input leaves as an InputError, which main() prints.
void addCheckCommand(CLI::App& app, int& exit_code);
void addSimulateCommand(CLI::App& app, int& exit_code);
void addExportCommand(CLI::App& app, int& exit_code);
void addContactsCommand(CLI::App& app, int& exit_code);
void addScopeCommand(CLI::App& app, int& exit_code);
void addIdentifyCommand(CLI::App& app, int& exit_code);
void addReplayCommand(CLI::App& app, int& exit_code);
void addPlantCommand(CLI::App& app, int& exit_code);
void addCommissionCommand(CLI::App& app, int& exit_code);
void addWhereCommand(CLI::App& app, int& exit_code);
void addBenchCommand(CLI::App& app, int& exit_code);
void addSweepCommand(CLI::App& app, int& exit_code);
void addKeysCommand(CLI::App& app, int& exit_code);
void addDoctorCommand(CLI::App& app, int& exit_code);
void addStatusCommand(CLI::App& app, int& exit_code);
void addSetCommand(CLI::App& app, int& exit_code);
void addReloadCommand(CLI::App& app, int& exit_code);
void addUndoCommand(CLI::App& app, int& exit_code);
void addDiffCommand(CLI::App& app, int& exit_code);
void addSaveCommand(CLI::App& app, int& exit_code);
void addStreamCommand(CLI::App& app, int& exit_code);
void addMoveCommand(CLI::App& app, int& exit_code);
void addFollowCommand(CLI::App& app, int& exit_code);
void addHoldCommand(CLI::App& app, int& exit_code);
void addCalibrateCommand(CLI::App& app, int& exit_code);
void addInitCommand(CLI::App& app, int& exit_code);
void addPanelCommand(CLI::App& app, int& exit_code);

}  // namespace tactus
