#pragma once

#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/drive_report.h"
#include "tactus/canopen/drive_setup.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/canopen/joint_tracking.h"
#include "tactus/canopen/pdo.h"
#include "tactus/canopen/still_watch.h"
#include "tactus/canopen/stop_watch.h"
#include "tactus/canopen/velocity_counts.h"

namespace tactus {

/// The master's side of one CiA 402 drive in cyclic synchronous velocity mode (9). Knows no socket
/// and no clock: time is counted in cycles. RPDO1 (0x200 + id): 6040 and 60FF; TPDO1 (0x180 + id):
/// 6041 and 6064, both synchronous. SYNC and the master's heartbeat are the bus's, not the drive's,
/// and have to go out in every phase, also while drives are configured.
///
/// A drive with a fault gets no velocity but 0, and a quick stop whatever is asked for. One that is
/// in fault when it is configured is reset once, on its way to kEnabled; a fault that comes later
/// is never cleared but by a restart. One that stays in quick stop active, as by option codes 5 to
/// 8, is taken out of it through switch on disabled, once it rests and is asked for kEnabled.
///
/// A drive may lie, or not hear. One that says that it boots while it is configured gets NMT reset
/// node, and is not off before it has booted once more: it may have run on. One that is not seen
/// off stop_deadline_s after a quick stop began, or that moves on meanwhile, is cut off: it gets
/// NMT stop instead of setpoints, and then its bus has to fall silent, for the drive's own watch
/// over SYNC and heartbeat to stop it.
class Drive {
 public:
  /// Feedback missing for more cycles than this is kDriveSilent.
  static constexpr int kMaxSilentCycles = 5;
  /// In which NMT stop is sent before the bus falls silent.
  static constexpr int kCuttingOffCycles = 20;

  /// Throws std::invalid_argument with one line for settings that no drive can be given.
  Drive(const DriveConfig& config, const CanopenConfig& canopen, double period_s);

  /// A data frame of this drive's bus; ids that are not its own are ignored. Frames of wrong size
  /// are counted and ignored.
  void receive(const CanFrame& frame) noexcept;

  /// For cycles that were missed just before this one: the deadlines of a stop go on in them.
  void coast(int missed_cycles) noexcept;

  /// Once a cycle, after all frames: judges what came, by what update() asked for last; place: for
  /// the following error.
  void observe(const CommandedPlace& place) noexcept;

  /// Then: sets what is to be sent. velocity: m/s or rad/s at the joint, used while kEnabled and
  /// enabled; position: where it is commanded to be, m or rad, for the tracking gain. restart: with
  /// kConfigure, start the set-up anew and forget all faults; for one cycle only.
  void update(DriveGoal goal, bool restart, double velocity, double position,
              FrameBatch& out) noexcept;

  /// At the end, in place of update(): a drive that was seen off, and was not told since to switch
  /// on, forgets mapping, heartbeat watch and setpoints, so that the end of the master's heartbeat
  /// is no fault to it. Any other keeps its watch, which stops it, and starts anew if it hears
  /// that.
  void release(FrameBatch& out) const noexcept;

  const DriveReport& report() const noexcept { return report_; }
  /// Cut off, and NMT stop has had its time: nothing may go to this drive's bus any more.
  bool needsSilence() const noexcept { return cut_off_cycles_ > kCuttingOffCycles; }
  int bus() const noexcept { return config_.bus; }
  std::uint32_t malformedFrames() const noexcept { return malformed_frames_; }

 private:
  enum class Phase : std::uint8_t {
    kUnconfigured,
    kSetup,     ///< objects are written
    kStarting,  ///< NMT start sent; waiting for its operational heartbeat and its feedback
    kConfigured,
    kRestarting,  ///< NMT reset node sent; waiting for its boot-up
  };

  void receiveFeedback(const CanFrame& frame) noexcept;
  void receiveHeartbeat(const CanFrame& frame) noexcept;
  void receiveEmergency(const CanFrame& frame) noexcept;
  void onBootUp() noexcept;
  void beginRestart() noexcept;

  void startSetup() noexcept;
  void continueSetup(FrameBatch& out) noexcept;
  void startAgain(FrameBatch& out) noexcept;
  void awaitOperation() noexcept;
  void onConfigured() noexcept;
  void watchRestart() noexcept;
  void makeRestart(FrameBatch& out) noexcept;
  void watchStop(DriveGoal goal) noexcept;
  void cutOff(FrameBatch& out) noexcept;
  bool hasLeftOperation() const noexcept;
  void stopNode(FrameBatch& out) noexcept;

  void countSilence() noexcept;
  void takeFeedback() noexcept;
  void watchSilence() noexcept;
  void watchFault() noexcept;
  void watchOperation() noexcept;
  bool isRunning(DriveGoal goal) const noexcept;
  std::uint16_t controlWord(DriveGoal goal) const noexcept;
  std::int32_t velocityCounts(DriveGoal goal, double velocity, double position) noexcept;
  void fail(Fault fault, const FaultDetail& detail = {}) noexcept;
  void failSilent(int cycles, int limit, const char* what) noexcept;
  FaultDetail emergencyDetail() const noexcept;

  DriveConfig config_;
  int heartbeat_timeout_cycles_;
  int answer_timeout_cycles_;
  DriveSetup setup_;
  VelocityCounts velocity_counts_;
  StillWatch quick_stopped_;  ///< at rest in quick stop active
  StopWatch stop_watch_;
  DriveGoal goal_ = DriveGoal::kSilent;  ///< of the last update()
  DriveReport report_;
  Phase phase_ = Phase::kUnconfigured;
  std::optional<DriveFeedback> feedback_;  ///< that has come since the last cycle
  int periods_heard_ = 0;                  ///< since then: each SYNC is answered once
  std::optional<DriveState> state_;        ///< none: a status word that the standard does not know
  bool is_operational_ = false;            ///< by its last heartbeat
  int starting_cycles_ = 0;                ///< since the first NMT start
  bool has_to_start_ = false;              ///< it has said so since the last one
  int cycles_without_feedback_ = 0;
  int cycles_without_heartbeat_ = 0;
  bool has_old_fault_ = false;  ///< in fault without a break since it was configured
  int reset_cycles_ = 0;        ///< since the reset of an old fault began
  int enabled_cycles_ = 0;      ///< in a row, counted up to where operation is settled
  int restart_cycles_ = 0;      ///< since NMT reset node was sent; 0: it has to be
  int cut_off_cycles_ = 0;      ///< up to silence
  int stop_node_cycles_ = 0;    ///< since NMT stop was sent; 0: it has to be
  std::uint32_t malformed_frames_ = 0;
};

}  // namespace tactus
