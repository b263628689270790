#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tactus/canopen/can_frame.h"

namespace tactus {

inline constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

/// Length on the bus with every stuff bit there can be, and the space to the next frame: of a
/// classic frame, and of all of a CAN FD frame that goes at the bus's bit rate.
int worstCaseBits(const CanFrame& frame) noexcept;
/// Of a CAN FD frame what goes at the data bit rate; of a classic one 0.
int worstCaseDataBits(const CanFrame& frame) noexcept;

/// What the other side's controller reports of itself, as linux/can/error.h defines it.
CanFrame unacknowledgedError() noexcept;
CanFrame busOffError() noexcept;
CanFrame busRestartedError() noexcept;

struct QueuedFrame {
  CanFrame frame;
  std::int64_t sent_ns = 0;  ///< when its sender handed it over
};

/// Frames waiting in a node, first in, first out. No heap.
class FrameQueue {
 public:
  static constexpr std::size_t kCapacity = 32;  ///< of a cycle: 16 drives, SYNC, heartbeat, SDO

  bool push(const QueuedFrame& item) noexcept;  ///< false, and dropped, when full
  void pop() noexcept;
  void clear() noexcept { size_ = 0; }
  bool empty() const noexcept { return size_ == 0; }
  std::size_t size() const noexcept { return size_; }
  const QueuedFrame& front() const noexcept { return items_[first_]; }

 private:
  std::array<QueuedFrame, kCapacity> items_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

/// A frame that has just been on the bus.
struct BusDelivery {
  int sender = 0;
  QueuedFrame item;
};

/// One CAN bus in time: whenever it is free, the lowest id among the heads of all queues goes, and
/// keeps the bus for as long as its bits take. Times never go back.
class PlantBus {
 public:
  static constexpr int kOtherSide = 0;    ///< the node that is no part of the plant
  static constexpr int kController = -1;  ///< "sender" of error frames for the other side

  /// nodes: with the other side, which is node 0. data_bit_rate_per_s: of CAN FD frames, which a
  /// bus without one does not carry.
  PlantBus(double bit_rate_per_s, int nodes, std::optional<double> data_bit_rate_per_s = {});

  /// False: the queue is full, the other side is in bus-off or the bus does not carry CAN FD, which
  /// is counted, or the node has no power.
  bool send(int node, const CanFrame& frame, std::int64_t t_ns) noexcept;

  /// Without power no node of the plant sends, hears or acknowledges: the other side's frame stays
  /// where it is and is tried again and again.
  void setPowered(bool is_powered, std::int64_t t_ns) noexcept;
  /// Bus-off: controller and kernel drop what the other side has to send, and refuse what it hands
  /// over meanwhile. It hears of no more than that, again and again, as an interface in that state
  /// refuses frames again and again.
  void setOtherSideOff(bool is_off, std::int64_t t_ns) noexcept;

  bool isPowered() const noexcept { return is_powered_; }
  bool isOtherSideOff() const noexcept { return is_other_side_off_; }
  std::uint64_t refused() const noexcept { return refused_; }
  std::size_t waiting(int node) const noexcept { return queues_[node].size(); }

  std::int64_t nextEvent_ns() const noexcept;
  /// What happens at nextEvent_ns(): a frame begins, ends, or is given up for a while, or the other
  /// side's controller has something to report.
  std::optional<BusDelivery> step() noexcept;

 private:
  enum class Phase : std::uint8_t { kIdle, kSending, kUnacknowledged };

  std::int64_t nextStart_ns() const noexcept;
  void start(std::int64_t t_ns) noexcept;
  std::optional<BusDelivery> report(std::int64_t t_ns) noexcept;
  void giveUp(std::int64_t t_ns) noexcept;
  void becomeIdle(std::int64_t t_ns) noexcept;
  std::int64_t duration_ns(const CanFrame& frame, int more_bits = 0) const noexcept;

  double bit_ns_;
  double data_bit_ns_;              ///< 0: no CAN FD
  std::vector<FrameQueue> queues_;  ///< one a node
  Phase phase_ = Phase::kIdle;
  int sender_ = kOtherSide;
  std::int64_t phase_end_ns_ = kNever_ns;
  std::int64_t free_from_ns_ = 0;
  std::int64_t next_report_ns_ = kNever_ns;  ///< of bus-off, or of its end
  bool is_powered_ = true;
  bool is_other_side_off_ = false;
  std::uint64_t refused_ = 0;
};

}  // namespace tactus
