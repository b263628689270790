#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/commission/object_reader.h"

namespace tactus {

/// A node that answers on a bus.
struct FoundNode {
  int bus = 0;
  int node_id = 0;
  std::optional<std::uint32_t> device_type;      ///< 1000:00
  std::optional<std::uint32_t> vendor, product;  ///< 1018:01, 1018:02
  std::optional<std::uint16_t> status_word;      ///< 6041:00
  /// Counts a turn of the drive's shaft, by its own objects 608F (increments a turn of the motor)
  /// and 6091 (turns of the motor a turn of the shaft), CiA 402-2.
  std::optional<double> counts_per_turn;
  bool has_twin = false;         ///< two devices answer to this id
  bool has_speed_limit = false;  ///< object 607F: it may heed the joint's limit of speed

  /// A device of CiA 402, by its device type.
  bool isDrive() const noexcept { return device_type && (*device_type & 0xFFFF) == 402; }
};

/// Asks all node ids of all buses, 1 to 127, by SDO. First all nodes are told to be
/// pre-operational: a stopped one answers no SDO, and one that runs for nobody stops.
class NodeScan {
 public:
  NodeScan(const HardwareConfig& hardware, double period_s);

  void receive(int bus, std::span<const CanFrame> frames) noexcept;
  /// Once a cycle, after all frames. outboxes: one a bus.
  void update(std::span<FrameBatch> outboxes) noexcept;
  bool isDone() const noexcept;
  std::vector<FoundNode> nodes() const;  ///< by bus and node id

 private:
  std::vector<BusReader> buses_;
  int settling_cycles_;  ///< after NMT
  int cycles_ = 0;
};

}  // namespace tactus
