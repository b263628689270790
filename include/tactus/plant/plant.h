#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/io/can_frame.h"
#include "tactus/io/hardware_config.h"
#include "tactus/plant/trouble.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// What a test asks of the plant after a run.
struct PlantCounters {
  std::uint64_t stale_setpoints_applied = 0;  ///< older than two periods when the drive took them
  std::uint64_t frames_refused = 0;           ///< by a full transmit queue
};

/// The robot as its buses see it: drives (CiA 402 slaves of our own making, apart from the master's
/// code), tactile module and obstacles, in one world. Every bus takes its time: a frame lasts as
/// many bits as it has, the lowest id goes first, queues are short. Knows no socket and no clock:
/// time is an argument, in ns since the plant was switched on.
class Plant {
 public:
  Plant(const ControllerConfig& robot, const PlantConfig& plant, const HardwareConfig& hardware,
        double period_s, std::vector<Trouble> troubles);

  /// A frame that the other side sends on a bus at a time not before the last one's.
  void send(int bus, const CanFrame& frame, std::int64_t t_ns) noexcept;

  /// Moves the world on to t_ns.
  void advance(std::int64_t t_ns) noexcept;

  /// Frames that have been on the bus since the last call, to be handed to the other side: of
  /// drives and module, and error frames; not those of the other side.
  void take(int bus, FrameBatch& frames) noexcept;

  /// When something next happens: nothing needs advance() before.
  std::int64_t nextEvent_ns() const noexcept;

  bool emergencyStop(std::int64_t t_ns) const noexcept;  ///< as scripted
};

}  // namespace tactus
