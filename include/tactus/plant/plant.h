#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/control/controller_config.h"
#include "tactus/plant/moteus_slave.h"
#include "tactus/plant/plant_bus.h"
#include "tactus/plant/slave_drive.h"
#include "tactus/plant/trouble.h"
#include "tactus/plant/troubles.h"
#include "tactus/sim/plant_config.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {

/// What a test asks of the plant after a run.
struct PlantCounters {
  std::uint64_t stale_setpoints_applied = 0;  ///< older than two periods when the drive took them
  std::uint64_t powers_taken_in_motion = 0;   ///< drives told to let go while they moved
  std::uint64_t frames_refused = 0;           ///< by a full transmit queue, or in bus-off
  std::uint64_t frames_not_taken = 0;         ///< lost because take() came too late
};

/// The robot as its buses see it: drives (of our own making, apart from the master's
/// code), tactile modules and obstacles, in one world. Every bus takes its time: a frame lasts as
/// many bits as it has, the lowest id goes first, queues are short. Knows no socket and no clock:
/// time is an argument, in ns since the plant was switched on.
///
/// The world moves in steps of the period. Its phase follows the other side: a step comes 0.5
/// periods after the first SYNC (and after the first one that follows a long silence), so that a
/// sample arrives before the other side wakes next. Obstacles and troubles count their time from
/// the moment the first drive was enabled.
class Plant {
 public:
  /// Throws std::invalid_argument if the period does not fit the tactile modules'.
  Plant(const ControllerConfig& robot, const PlantConfig& plant, const HardwareConfig& hardware,
        double period_s, std::vector<Trouble> troubles);

  /// A frame that the other side sends on a bus at a time not before the last one's.
  void send(int bus, const CanFrame& frame, std::int64_t t_ns) noexcept;

  /// Moves the world on to t_ns.
  void advance(std::int64_t t_ns) noexcept;

  /// Frames that have been on the bus since the last call, to be handed to the other side: of
  /// drives and modules, and error frames; not those of the other side. Replaces what `frames`
  /// held.
  void take(int bus, FrameBatch& frames) noexcept;

  /// Replaces the script once a drive was enabled; its times count from now, t_ns.
  void play(std::vector<Trouble> troubles, std::int64_t t_ns);

  /// When something next happens: nothing needs advance() before.
  std::int64_t nextEvent_ns() const noexcept;

  bool emergencyStop(std::int64_t t_ns) const noexcept;  ///< as scripted

  PlantCounters counters() const noexcept;
  int buses() const noexcept { return static_cast<int>(links_.size()); }
  /// Of CiA 402.
  const SlaveDrive& drive(int joint) const { return std::get<SlaveDrive>(drives_[joint].drive); }
  const MoteusSlave& moteus(int joint) const { return std::get<MoteusSlave>(drives_[joint].drive); }
  PowerState powerState(int joint) const noexcept;
  const PlantBus& bus(int bus) const noexcept { return links_[bus].bus; }
  const SimulatedRobot& world() const noexcept { return world_; }
  bool wasEnabled() const noexcept { return script_.hasStarted(); }  ///< a drive, ever

 private:
  /// A bus with what goes wrong on it, and what it has for the other side.
  struct Link {
    PlantBus bus;
    FrameTroubles troubles;
    FrameBatch inbox;
  };
  struct Node {
    std::variant<SlaveDrive, MoteusSlave> drive;
    int bus;
    int number;  ///< on the bus, from 1
    std::uint32_t id;
    std::int64_t next_event_ns = 0;  ///< the drive's, since collect(): it takes a while to know
  };

  /// A tactile module on its bus.
  struct Module {
    int bus;
    std::uint32_t first_id;
    int number;                         ///< on the bus, from 1
    std::uint32_t sample_sequence = 0;  ///< of the sample that was sent last
  };

  void step(std::int64_t t_ns) noexcept;
  void applyTroubles(std::int64_t t_ns) noexcept;
  void applyBusTroubles(int bus, std::int64_t t_ns) noexcept;
  DriveTroubles troublesOf(const Node& node, std::int64_t t_ns) const noexcept;
  void moveBus(int bus, std::int64_t t_ns) noexcept;
  void deliver(int bus, const BusDelivery& delivery, std::int64_t t_ns) noexcept;
  /// Gives a frame to a drive.
  void tell(Node& node, const QueuedFrame& item, std::int64_t t_ns) noexcept;
  void hearSync(std::int64_t t_ns) noexcept;
  void give(Link& link, const CanFrame& frame) noexcept;
  static void noteNextEvent(Node& node) noexcept;
  /// After all that was done to a drive.
  void collect(Node& node, std::int64_t t_ns) noexcept;
  void moveWorld(std::int64_t t_ns) noexcept;
  void sendSamples(std::int64_t t_ns) noexcept;
  void noticeEnabling(std::int64_t t_ns) noexcept;

  HardwareConfig hardware_;
  double period_s_;
  std::int64_t period_ns_;
  SimulatedRobot world_;
  RobotInput seen_;  ///< what encoders and modules see
  JointVector velocity_;
  TroubleScript script_;
  std::vector<Link> links_;   ///< one a bus
  std::vector<Node> drives_;  ///< one a joint
  std::vector<Module> modules_;
  std::int64_t now_ns_ = 0;
  std::int64_t next_move_ns_;
  std::int64_t next_trouble_ns_ = kNever_ns;
  std::int64_t last_sync_ns_;
  std::uint64_t frames_not_taken_ = 0;
  std::uint64_t powers_taken_in_motion_ = 0;
};

}  // namespace tactus
