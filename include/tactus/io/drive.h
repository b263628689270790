#pragma once

#include <cstdint>

#include "tactus/control/fault.h"
#include "tactus/io/can_frame.h"
#include "tactus/io/cia402.h"
#include "tactus/io/hardware_config.h"
#include "tactus/io/sdo_client.h"

namespace tactus {

/// What the daemon wants of a drive this cycle.
enum class DriveGoal : std::uint8_t {
  kSilent,     ///< send nothing to it
  kConfigure,  ///< NMT pre-operational, write the set-up by SDO, NMT start; then as kDisabled
  kDisabled,   ///< configured, power off
  kEnabled,    ///< operation enabled, following the velocity setpoint
  kQuickStop,  ///< stop by itself, then switch on disabled
};

/// Why a drive could not be configured: the object and the abort code, 0 for a time-out.
struct SetupFailure {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint32_t abort_code = 0;
};

/// What is known of a drive after a cycle's frames.
struct DriveReport {
  bool is_configured = false;
  DriveState state = DriveState::kNotReady;
  bool has_position = false;
  double position = 0.0;       ///< m or rad
  Fault fault = Fault::kNone;  ///< kDriveSilent, kDriveFault, kDriveStateLost, kFollowingError or
                               ///< kDriveSetupRefused; stays until kConfigure starts anew
  std::uint16_t emergency_code = 0;  ///< of the last EMCY, 0: none
  SetupFailure setup_failure;
};

/// The master's side of one CiA 402 drive in cyclic synchronous velocity mode (9). Knows no socket
/// and no clock: time is counted in cycles. RPDO1 (0x200 + id): 6040 and 60FF; TPDO1 (0x180 + id):
/// 6041 and 6064, both synchronous. SYNC and the master's heartbeat are the bus's, not the drive's.
class Drive {
 public:
  /// Feedback missing for more cycles than this is kDriveSilent.
  static constexpr int kMaxSilentCycles = 5;

  Drive(const DriveConfig& config, const CanopenConfig& canopen, double period_s);

  /// A data frame of this drive's bus; ids that are not its own are ignored. Frames of wrong size
  /// are counted and ignored.
  void receive(const CanFrame& frame) noexcept;

  /// Once a cycle, after all frames: sets what is to be sent, and judges what came. velocity: m/s
  /// or rad/s at the joint, used while kEnabled and enabled; position: where the drive is commanded
  /// to be at the start of this cycle, for the following error and the tracking gain. restart: with
  /// kConfigure, start the set-up anew and forget all faults.
  void update(DriveGoal goal, bool restart, double velocity, double position,
              FrameBatch& out) noexcept;

  const DriveReport& report() const noexcept { return report_; }
  int bus() const noexcept { return config_.bus; }

 private:
  // ... the implementation's own
  DriveConfig config_;
  DriveReport report_;
};

}  // namespace tactus
