#pragma once

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/io/can_socket.h"

namespace tactus {

/// A bus of the robot, for one program alone. Throws what CanSocket and InterfaceLock throw.
struct BusPort {
  BusPort(const HardwareConfig& hardware, int bus);

  /// What has come since, into `frames`; returns the bus's fault.
  Fault receive() noexcept;

  InterfaceLock lock;
  CanSocket socket;
  FrameBatch frames;
};

}  // namespace tactus
