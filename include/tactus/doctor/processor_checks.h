#pragma once

#include "tactus/doctor/finding.h"
#include "tactus/doctor/machine_files.h"

namespace tactus {

/// Whether the clock of the loop's CPU (-1: of all) stands still.
Finding checkGovernor(const MachineRoot& root, int cpu);

/// Whether the loop has a CPU for itself. cpu: the loop's; -1: any.
Finding checkIsolation(const MachineRoot& root, int cpu);

}  // namespace tactus
