#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tactus/io/bus_monitor.h"
#include "tactus/io/can_frame.h"

namespace tactus {

/// Ids that match (id & mask) == (filter.id & mask); standard data frames only.
struct IdFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FF;
};

/// One raw CAN socket, bound to one interface. Data frames by exact filters, error frames on, own
/// frames echoed as confirmation to the monitor. One recvmmsg and one sendmmsg a cycle.
class CanSocket {
 public:
  /// Throws std::system_error whose text names interface, what failed and what to do.
  CanSocket(const std::string& interface, std::span<const IdFilter> filters);
  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// All frames waiting (as many as the batch holds), without own echoes, error and foreign frames:
  /// these go to the monitor. One system call, never waits.
  void receive(FrameBatch& frames) noexcept;
  /// Hands frames to the kernel if the monitor lets it. One system call, never waits.
  void send(std::span<const CanFrame> frames) noexcept;

  BusMonitor& monitor() noexcept { return monitor_; }
  const BusMonitor& monitor() const noexcept { return monitor_; }
  int descriptor() const noexcept { return descriptor_; }

 private:
  int descriptor_ = -1;
  BusMonitor monitor_;
};

/// Held while a daemon owns an interface: a second one on it throws std::runtime_error. Freed by
/// the kernel whenever the process ends.
class InterfaceLock {
 public:
  explicit InterfaceLock(const std::string& interface);
  ~InterfaceLock();
  InterfaceLock(const InterfaceLock&) = delete;
  InterfaceLock& operator=(const InterfaceLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace tactus
