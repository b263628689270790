#pragma once

#include <string>
#include <vector>

#include "tactus/doctor/finding.h"
#include "tactus/doctor/machine_files.h"

namespace tactus {

/// Whether the loop goes before the kernel's interrupt threads.
Finding checkLoopPriority(int loop_priority);

/// The interrupt threads of a CAN interface's controller: before those of disk and network, behind
/// the loop. None for an interface without hardware.
std::vector<Finding> checkInterrupts(const MachineRoot& root, const std::string& interface,
                                     int loop_priority);

}  // namespace tactus
