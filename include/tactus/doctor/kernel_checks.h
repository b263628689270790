#pragma once

#include "tactus/doctor/finding.h"
#include "tactus/doctor/machine_files.h"

namespace tactus {

/// Whether the kernel can be preempted everywhere.
Finding checkPreemption(const MachineRoot& root);

/// How much time the kernel leaves to real-time threads.
Finding checkThrottling(const MachineRoot& root);

/// What the kernel was built with: RT_GROUP_SCHED gives real time to control groups, and none to
/// most of them. nullopt: it does not tell.
std::optional<bool> hasRealTimeGroups(const MachineRoot& root);

/// Whether the control group of this process may have real-time threads at all.
Finding checkControlGroup(const MachineRoot& root);

}  // namespace tactus
