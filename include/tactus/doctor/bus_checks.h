#pragma once

#include <optional>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/doctor/finding.h"
#include "tactus/doctor/machine_files.h"
#include "tactus/io/can_link.h"

namespace tactus {

/// A bus's interface: there, up and on the bus, its adapter, bit rates, modes, CAN FD where the bus
/// is to have it, queue, and what it does after bus-off. `link`: what the kernel says of it.
std::vector<Finding> checkBus(const MachineRoot& root, const BusConfig& bus,
                              const std::optional<CanLink>& link);

}  // namespace tactus
