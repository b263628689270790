#pragma once

#include <cstdint>

#include "tactus/canopen/can_frame.h"
#include "tactus/control/fault.h"

namespace tactus {

/// An arm may run for months: 32 bits of frames would be full after twelve days.
struct BusCounters {
  std::uint64_t received = 0;
  std::uint64_t sent = 0;
  std::uint64_t refused = 0;    ///< frames that the kernel refused (ENOBUFS, EAGAIN), and dropped
  std::uint64_t held_back = 0;  ///< cycles in which nothing was sent because of the bus's state
  std::uint64_t error_frames = 0;
  std::uint64_t foreign = 0;  ///< remote, extended or truncated frames: none of ours
};

/// Judges a bus by what its socket meets and decides whether frames may be sent. At most one
/// cycle's frames are ever in the kernel: the next ones go only after the last were confirmed
/// (echoed by the kernel once they were on the bus), so that nothing stale is sent when a dead bus
/// comes back. Knows no socket and no clock: time is counted in cycles.
///
/// A frame given to the kernel cannot be taken back, so a dead bus is answered in three steps:
/// - Purge: nothing more is handed over. What the kernel holds is at most the frames of the last
///   cycle; the controller drops them (bus-off, interface down) or sends them when it can.
/// - Probe: each `probe_cycles` cycles one harmless frame (a heartbeat) may go, also while others
///   wait, as drivers may lose frames without a word.
/// - Re-arm: once all frames are confirmed and kCalmCycles cycles have passed without trouble, the
///   kernel is empty and the bus works. Frames that a bus which answers again never confirms were
///   lost; then it takes another probe.
/// A passing stall of up to kMaxUnconfirmedCycles cycles holds frames back and does no more. A
/// longer one is kBusStalled; on a bus that has given no sign of life since the start it is
/// kBusUnacknowledged: its cable or its power is missing.
class BusMonitor {
 public:
  static constexpr int kMaxUnconfirmedCycles = 3;
  static constexpr int kProbeCycles = 100;
  static constexpr int kCalmCycles = 20;
  /// Batches in a row that were full: more than copper carries, and than the socket keeps while
  /// nobody reads.
  static constexpr int kMaxFullBatches = 3;
  /// After so many frames that were confirmed a controller is passive no more, whether its driver
  /// says so or not: its counter of errors, 255 at most, is back below 128.
  static constexpr int kFramesToActive = 128;

  explicit BusMonitor(int probe_cycles = kProbeCycles) noexcept : probe_cycles_(probe_cycles) {}

  void onErrorFrame(const CanFrame& frame) noexcept;
  void onConfirmed(int frames) noexcept;  ///< own frames that came back as echo
  void onSent(int accepted, int offered) noexcept;
  void onSendError(int error_number) noexcept;  ///< errno of a send; onSent(0, offered) as well
  void onReceiveError(int error_number) noexcept;
  void onForeignFrame() noexcept;
  void onReceived(int frames, bool batch_was_full) noexcept;

  /// Once a cycle, after receiving and before sending.
  void update() noexcept;

  /// Setpoints and all else; false: keep quiet this cycle, or send the probe only.
  bool maySend() const noexcept { return !isDead() && unconfirmed_ == 0; }
  /// On a dead bus, now and then one harmless frame tells whether it has come back.
  bool mayProbe() const noexcept { return isDead() && cycles_to_probe_ == 0; }
  /// kNone, kBusStalled, kBusUnacknowledged, kBusOff, kBusDown or kBusFlooded; goes back to kNone
  /// only after the bus has confirmed frames again. Of several the gravest.
  Fault fault() const noexcept { return fault_; }
  const BusCounters& counters() const noexcept { return counters_; }

 private:
  /// A flooded bus still carries our frames, which are needed to stop.
  bool isDead() const noexcept { return fault_ != Fault::kNone && fault_ != Fault::kBusFlooded; }
  void raise(Fault trouble) noexcept;
  void noteProbe() noexcept;
  void noteUnconfirmed() noexcept;
  void noteFlood() noexcept;
  void recover() noexcept;
  void rearm() noexcept;

  int probe_cycles_;
  BusCounters counters_;
  Fault fault_ = Fault::kNone;
  Fault trouble_ = Fault::kNone;  ///< of this cycle
  int unconfirmed_ = 0;           ///< frames that the kernel may still hold
  int stuck_cycles_ = 0;          ///< in a row with frames unconfirmed or refused
  int full_batches_ = 0;          ///< in a row
  int calm_cycles_ = 0;
  int cycles_to_probe_ = 0;
  bool is_passive_ = false;
  int frames_to_active_ = 0;        ///< until a passive controller has to be active again
  bool lacks_acknowledge_ = false;  ///< since the last confirmation
  bool was_refused_ = false;        ///< this cycle
  bool was_confirmed_ = false;      ///< this cycle
  bool is_known_alive_ = false;     ///< a frame was confirmed or heard since the start
  bool has_answered_ = false;       ///< a frame was confirmed since the last trouble
};

}  // namespace tactus
