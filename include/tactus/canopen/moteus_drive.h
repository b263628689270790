#pragma once

#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/drive_report.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/canopen/joint_tracking.h"
#include "tactus/canopen/moteus_frames.h"
#include "tactus/canopen/still_watch.h"
#include "tactus/canopen/stop_watch.h"

namespace tactus {

/// The master's side of one moteus controller, which follows a velocity from where it is. Knows no
/// socket and no clock: time is counted in cycles. Each cycle it gets one command and replies.
///
/// Set up, it has the register map that is known, mode stopped, no fault, and knows where it is, by
/// what DriveConfig::home says.
/// One that still moves is slowed down before, and one in fault is told to stop, which clears it; a
/// fault that comes later is never cleared but by a restart. A drive that is to stop is told zero
/// velocity until it rests, and then to stop, which leaves it without torque. One that is not seen
/// off stop_deadline_s after a quick stop began, or that moves on meanwhile, gets nothing more: if
/// it still follows a velocity, its watchdog of heartbeat_timeout_s ends that.
class MoteusDrive {
 public:
  static constexpr int kMaxSilentCycles = 5;  ///< replies missing for more are kDriveSilent

  /// Throws std::invalid_argument with one line for settings that no drive can be given.
  MoteusDrive(const DriveConfig& config, const CanopenConfig& canopen, double period_s);

  /// As those of Drive.
  void receive(const CanFrame& frame) noexcept;
  void coast(int missed_cycles) noexcept;
  void observe(const CommandedPlace& place) noexcept;
  void update(DriveGoal goal, bool restart, double velocity, double position,
              FrameBatch& out) noexcept;
  void release(FrameBatch& out) const noexcept;

  const DriveReport& report() const noexcept { return report_; }
  bool needsSilence() const noexcept { return false; }  ///< it has its own: others go on
  int bus() const noexcept { return config_.bus; }
  std::uint32_t malformedFrames() const noexcept { return malformed_frames_; }

 private:
  enum class Phase : std::uint8_t { kUnconfigured, kSetup, kConfigured };

  void startSetup() noexcept;
  void judgeSetup() noexcept;
  bool isHome() const noexcept;
  void refuseSetup() noexcept;
  void countSilence() noexcept;
  void takeReply() noexcept;
  void takePosition(const MoteusReply& reply) noexcept;
  void judgeOperation(const CommandedPlace& place) noexcept;
  void watchStop(DriveGoal goal) noexcept;
  bool isRunning(DriveGoal goal) const noexcept;
  MoteusCommand command(DriveGoal goal, double velocity, double position) noexcept;
  MoteusCommand::Kind stopping() const noexcept;
  float turnsPerSecond(double velocity, double position) const noexcept;
  void fail(Fault fault, const FaultDetail& detail = {}) noexcept;

  DriveConfig config_;
  float watchdog_s_;
  int boot_timeout_cycles_;
  StillWatch still_watch_;
  StopWatch stop_watch_;
  DriveReport report_;
  DriveGoal goal_ = DriveGoal::kSilent;  ///< of the last update()
  Phase phase_ = Phase::kUnconfigured;
  std::optional<MoteusReply> reply_;  ///< that has come since the last cycle
  std::optional<MoteusReply> last_;   ///< the newest of this set-up
  bool is_asked_ = false;             ///< the last update() sent a command
  int setup_cycles_ = 0;
  int silent_cycles_ = 0;
  int resting_cycles_ = 0;  ///< in a row
  int enabled_cycles_ = 0;  ///< in a row, counted up to where operation is settled
  int periods_heard_ = 0;
  std::uint32_t malformed_frames_ = 0;
};

}  // namespace tactus
