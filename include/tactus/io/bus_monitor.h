#pragma once

#include <cstdint>

#include "tactus/control/fault.h"
#include "tactus/io/can_frame.h"

namespace tactus {

struct BusCounters {
  std::uint32_t received = 0;
  std::uint32_t sent = 0;
  std::uint32_t refused = 0;    ///< sends that the kernel refused (ENOBUFS, EAGAIN)
  std::uint32_t held_back = 0;  ///< cycles in which nothing was sent because of the bus's state
  std::uint32_t error_frames = 0;
  std::uint32_t foreign = 0;  ///< remote, extended or truncated frames: none of ours
};

/// Judges a bus by what its socket meets and decides whether frames may be sent. At most one
/// cycle's frames are ever in the kernel: the next ones go only after the last were confirmed
/// (echoed by the kernel once they were on the bus), so that nothing stale is sent when a dead bus
/// comes back. Knows no socket and no clock: time is counted in cycles.
class BusMonitor {
 public:
  static constexpr int kMaxUnconfirmedCycles = 3;

  void onErrorFrame(const CanFrame& frame) noexcept;
  void onConfirmed(int frames) noexcept;  ///< own frames that came back as echo
  void onSent(int accepted, int offered) noexcept;
  void onSendError(int error_number) noexcept;  ///< errno of a send
  void onReceiveError(int error_number) noexcept;
  void onForeignFrame() noexcept;
  void onReceived(int frames, bool batch_was_full) noexcept;

  /// Once a cycle, before sending.
  void update() noexcept;

  /// Setpoints and all else; false: keep quiet this cycle, or send the probe only.
  bool maySend() const noexcept;
  /// On a dead bus, now and then one harmless frame tells whether it has come back.
  bool mayProbe() const noexcept;
  /// kNone, kBusStalled, kBusUnacknowledged, kBusOff, kBusDown or kBusFlooded; goes back to kNone
  /// only after the bus has confirmed frames again.
  Fault fault() const noexcept;
  const BusCounters& counters() const noexcept;
};

}  // namespace tactus
