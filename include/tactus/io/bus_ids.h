#pragma once

#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/io/can_socket.h"

namespace tactus {

/// The ids that the daemon reads from and writes to a bus.
struct BusIds {
  std::vector<IdFilter> received, sent;
};

BusIds busIds(const HardwareConfig& hardware, int bus);

}  // namespace tactus
