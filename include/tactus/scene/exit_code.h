#pragma once

namespace tactus {

/// Exit codes of all programs.
enum ExitCode { kExitDone = 0, kExitBadInput = 1, kExitUsage = 2, kExitFault = 3 };

}  // namespace tactus
