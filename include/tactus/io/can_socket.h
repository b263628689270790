#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "tactus/canopen/can_frame.h"
#include "tactus/io/bus_monitor.h"

namespace tactus {

/// Ids that match (id & mask) == (filter.id & mask); data frames only, of one kind.
struct IdFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FF;
  bool is_extended = false;  ///< 29-bit ids, and a mask of as many
  bool is_fd = false;        ///< frames of CAN FD
};

/// One raw CAN socket, bound to one interface. Data frames by exact filters, error frames on, own
/// frames echoed as confirmation to the monitor. One recvmmsg and one sendmmsg a cycle. Ids of
/// other lengths, remote frames and, on a classic bus, FD frames are kept out by the kernel
/// already; every frame is checked all the same.
class CanSocket {
 public:
  /// received: ids that receive() returns. sent: ids that go out; the kernel filters echoes as it
  /// does all frames, so without its id a frame is never confirmed and the bus taken for stalled.
  /// is_fd: the bus carries CAN FD, which its interface has to be set up for. Throws
  /// std::system_error whose text names interface, what failed and what to do.
  CanSocket(const std::string& interface, std::span<const IdFilter> received,
            std::span<const IdFilter> sent, bool is_fd = false);
  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// All frames waiting (as many as the batch holds), without own echoes, error and foreign frames:
  /// these go to the monitor. One system call, never waits.
  void receive(FrameBatch& frames) noexcept;
  /// Once a cycle: hands frames to the kernel if the monitor lets it. What is not accepted is
  /// dropped: the next cycle has newer ones. One system call, never waits. Returns whether the
  /// first one was accepted.
  bool send(std::span<const CanFrame> frames) noexcept;
  /// Once a cycle: hands over a frame that does no harm, where the monitor wants a probe; send()
  /// then does nothing.
  void probe(const CanFrame& harmless) noexcept;

  BusMonitor& monitor() noexcept { return monitor_; }
  const BusMonitor& monitor() const noexcept { return monitor_; }
  int descriptor() const noexcept { return descriptor_; }

 private:
  struct Messages;

  int handOver(std::span<const CanFrame> frames) noexcept;
  /// True: a data frame for the caller, put into `frame`.
  bool take(std::size_t message, CanFrame& frame) noexcept;
  bool isExpected(const CanFrame& frame) const noexcept;

  int descriptor_ = -1;
  BusMonitor monitor_;
  std::unique_ptr<Messages> messages_;  ///< all that the kernel reads and writes, allocated once
};

/// Frames that an interface queues for its controller, set by the administrator:
/// `ip link set can0 txqueuelen 10`. Throws std::system_error.
int transmitQueueLength(const std::string& interface);
/// A longer one delays what follows; a cycle's frames fit: of 16 drives, SYNC and heartbeat.
inline constexpr int kMaxTransmitQueue = 20;
/// In which a cycle of so many drives fits, with SYNC and heartbeat.
constexpr int transmitQueueFor(int drives) noexcept { return drives > 8 ? kMaxTransmitQueue : 10; }

/// Throws std::system_error where the interface is down or missing, with the way to mend it.
void requireUp(const std::string& interface);

/// Throws std::system_error where the interface is set up for classic frames alone.
void requireFd(const std::string& interface);

/// Held while a daemon owns an interface: a second one on it throws std::runtime_error. Freed by
/// the kernel whenever the process ends. Holds in one network namespace, as interfaces do. Whoever
/// plays the robot may be there, too, but once: each program has its own lock.
class InterfaceLock {
 public:
  explicit InterfaceLock(const std::string& interface, const std::string& program = "tactusd");
  ~InterfaceLock();
  InterfaceLock(const InterfaceLock&) = delete;
  InterfaceLock& operator=(const InterfaceLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace tactus
