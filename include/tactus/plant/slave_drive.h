#pragma once

#include <cstdint>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/plant/object_dictionary.h"
#include "tactus/plant/plant_bus.h"
#include "tactus/plant/slave_axis.h"

namespace tactus {

/// NMT states of a CANopen node, as its heartbeat spells them; kOff has none.
enum class NodeState : std::uint8_t {
  kInitialising = 0,
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 127,
  kOff = 255,
};

/// What is wrong with a drive now; see Trouble::Kind.
struct DriveTroubles {
  bool is_failing = false;  ///< in fault, which can't be reset
  bool ignores_commands = false;
  bool freezes_feedback = false;
  bool tells_nonsense = false;  ///< as its status
  bool claims_boot_up = false;  ///< once, when this begins
  bool watches_heartbeat_only = false;
};

/// A velocity drive as a CANopen slave (CiA 301). It stops by itself, with a fault, when the
/// master's heartbeat or SYNC stays away, or RPDOs for longer than 1400:05 says, or when it is
/// taken out of operational while enabled. Times in ns since the plant was switched on.
class SlaveDrive {
 public:
  static constexpr std::int64_t kBootTime_ns = 50'000'000;
  static constexpr int kMaxMissingSyncs = 5;

  /// Switched off.
  SlaveDrive(const DriveConfig& config, double period_s);

  void setPowered(bool is_on, std::int64_t t_ns) noexcept;
  void setTroubles(const DriveTroubles& troubles) noexcept;
  void receive(const QueuedFrame& item, std::int64_t t_ns) noexcept;
  /// Does what is due by the drive's own timers.
  void update(std::int64_t t_ns) noexcept;
  std::int64_t nextEvent_ns() const noexcept;

  /// Drives for dt_s; see SlaveAxis.
  void move(double dt_s) noexcept;
  void setPosition(double q) noexcept { axis_.setPosition(q, objects_); }

  /// What the drive has to say, to be sent and cleared.
  FrameBatch& outbox() noexcept { return outbox_; }

  NodeState nmtState() const noexcept { return nmt_; }
  PowerState powerState() const noexcept { return axis_.state(); }
  double velocity() const noexcept { return axis_.velocity(); }  ///< m/s or rad/s
  const ObjectDictionary& objects() const noexcept { return objects_; }
  /// RPDOs older than two periods when they took effect in operation enabled.
  std::uint64_t staleSetpoints() const noexcept { return stale_setpoints_; }

 private:
  bool isConnected() const noexcept;
  std::uint32_t idFrom(std::uint32_t function) const noexcept;
  void onNmt(const CanFrame& frame, std::int64_t t_ns) noexcept;
  void onSdo(const CanFrame& frame, std::int64_t t_ns) noexcept;
  void onRpdo(const QueuedFrame& item, std::int64_t t_ns) noexcept;
  void onSync(const CanFrame& frame, std::int64_t t_ns) noexcept;
  void restart(std::uint16_t last_index, std::int64_t t_ns) noexcept;
  void finishBoot() noexcept;
  void enter(NodeState state) noexcept;
  void applyRpdo(const QueuedFrame& item, std::int64_t t_ns) noexcept;
  void obey(std::int64_t t_ns) noexcept;
  void fail(std::uint16_t error_code) noexcept;
  void abortConnection(std::uint16_t error_code) noexcept;
  std::int64_t masterTimeout_ns() const noexcept;
  std::int64_t heartbeatPeriod_ns() const noexcept;
  bool watchesMotion() const noexcept;
  std::int64_t syncDeadline_ns() const noexcept;
  std::int64_t rpdoDeadline_ns() const noexcept;
  void sendTpdoAtSync() noexcept;
  void sendTpdoOnChange() noexcept;
  void sendTpdo() noexcept;
  void packFeedback(CanFrame& frame) const noexcept;
  void sendEmergency(std::uint16_t error_code) noexcept;
  void sendNmtState(std::uint8_t state) noexcept;

  DriveConfig config_;
  std::int64_t max_setpoint_age_ns_;
  ObjectDictionary objects_;
  SlaveAxis axis_;
  NodeState nmt_ = NodeState::kOff;
  FrameBatch outbox_;
  DriveTroubles troubles_;
  std::uint32_t frozen_status_ = 0;
  std::uint32_t frozen_position_ = 0;
  QueuedFrame latched_rpdo_;
  bool has_latched_rpdo_ = false;
  std::uint32_t sent_status_ = 0;
  std::uint32_t syncs_since_tpdo_ = 0;
  std::int64_t boot_end_ns_ = kNever_ns;
  std::int64_t next_heartbeat_ns_ = kNever_ns;
  std::int64_t master_deadline_ns_ = kNever_ns;  ///< armed by the master's first heartbeat
  std::int64_t last_sync_ns_ = 0;                ///< or when operation was enabled, if later
  std::int64_t last_rpdo_ns_ = 0;                ///< likewise
  std::uint64_t stale_setpoints_ = 0;
};

}  // namespace tactus
