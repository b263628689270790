#pragma once

#include "tactus/doctor/finding.h"
#include "tactus/doctor/machine_files.h"

namespace tactus {

/// What this process may do, and whose rights these are. Says nothing of the service's.
Finding checkProcessRights(const MachineRoot& root, int priority);

/// What systemd grants to tactusd.service, if that is installed. has_real_time_groups: of the
/// kernel, see hasRealTimeGroups().
Finding checkServiceRights(const MachineRoot& root, int priority,
                           const std::optional<bool>& has_real_time_groups);

}  // namespace tactus
