#pragma once

namespace tactus {

/// What main() of tactusd does, from its arguments to its exit code (see exit_code.h).
int tactusdProgram(int argc, char** argv);

}  // namespace tactus
