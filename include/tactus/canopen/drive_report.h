#pragma once

#include <cstdint>

#include "tactus/canopen/cia402.h"
#include "tactus/canopen/drive_setup.h"
#include "tactus/control/fault.h"

/// What drives of every kind have in common: what is asked of them, and what is known of them.
namespace tactus {

/// What the daemon wants of a drive this cycle.
enum class DriveGoal : std::uint8_t {
  kSilent,     ///< send nothing to it
  kConfigure,  ///< see whether it is the right one, set it up; then as kDisabled
  kDisabled,   ///< configured, power off
  kEnabled,    ///< following the velocity setpoint
  kQuickStop,  ///< stop by itself, then power off
};

/// What is known of a drive after a cycle's frames.
struct DriveReport {
  bool is_configured = false;
  DriveState state = DriveState::kNotReady;  ///< of CiA 402, or what comes nearest to it
  bool has_state = false;                    ///< the last status was one that is known
  bool is_silent = false;                    ///< now: out of reach, so that `state` is an old one
  /// When last heard of it had no power: its status said so, or it has started anew. What is
  /// not seen off is dealt with as if it moved.
  bool is_off = false;
  bool is_restarting = false;  ///< it said that it boots, and was reset to make sure of that
  bool is_moving_on = false;   ///< in its quick stop it goes on as fast as before
  /// Not seen off in time, or moving on: it gets NMT stop, and then silence on its bus.
  bool is_cut_off = false;
  bool has_position = false;
  double position = 0.0;  ///< m or rad
  /// kDriveSilent, kDriveFault, kDriveStateLost, kFollowingError, kDriveSetupRefused, or
  /// kCommandNotFinite if a setpoint was NaN or infinite; the first one stays until kConfigure
  /// starts anew.
  Fault fault = Fault::kNone;
  FaultDetail detail;                ///< of that fault: what it was judged by
  std::uint16_t emergency_code = 0;  ///< of the last EMCY, or the fault code; 0: none
  SetupFailure setup_failure;
};

/// Only the first fault counts.
inline void latch(Fault fault, const FaultDetail& detail, DriveReport& report) noexcept {
  if (report.fault != Fault::kNone) return;
  report.fault = fault;
  report.detail = detail;
}

}  // namespace tactus
