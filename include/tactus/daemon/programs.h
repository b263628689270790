#pragma once

namespace tactus {

/// What main() of each program does, from its arguments to its exit code (see commands.h).
int tactusProgram(int argc, char** argv);
int tactusdProgram(int argc, char** argv);

}  // namespace tactus
