#pragma once

#include <memory>
#include <vector>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/io/can_socket.h"

namespace tactus {

/// A bus of the robot, for one program alone. Throws what CanSocket and InterfaceLock throw.
struct BusPort {
  BusPort(const HardwareConfig& hardware, int bus, double period_s);

  /// What has come since, into `frames`; returns the bus's fault.
  Fault receive() noexcept;
  /// probe: what may go onto a bus that is dead. Returns as CanSocket::send().
  bool send(const FrameBatch& outbox, const CanFrame& probe) noexcept;

  InterfaceLock lock;
  CanSocket socket;
  FrameBatch frames;
};

/// All of the robot's, or none.
std::vector<std::unique_ptr<BusPort>> openBuses(const HardwareConfig& hardware, double period_s);

}  // namespace tactus
