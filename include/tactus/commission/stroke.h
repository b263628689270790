#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "tactus/canopen/can_robot.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/commission/stroke_figures.h"
#include "tactus/commission/stroke_motion.h"
#include "tactus/supervisor/brake.h"
#include "tactus/supervisor/line_states.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// What a cycle knows beside frames.
struct CommissionInput {
  GpioInputs lines;
  bool are_lines_lost = false;
  std::array<Fault, kMaxBuses> bus_faults{};
  int missed_cycles = 0;        ///< just before this one
  bool stop_requested = false;  ///< come to rest and switch off, now
};

/// Bounds of a motion, in the joint's unit as it is believed to be.
struct StrokeBounds {
  /// The fewest counts that a m or rad may have: then the true way is never longer, the true speed
  /// never larger than the believed one.
  double counts_per_unit = 1.0;
  double max_travel = 0.0;
  MotionLimits limits{};
  double max_following_error = 0.0;
};

struct StrokePlan {
  int bus = 0;
  int node_id = 0;
  StrokeBounds bounds;
  StrokeShape shape;  ///< |distance| <= bounds.max_travel
  /// What the set-up has to know of the drive beyond CiA 402, of robot.yaml, its data sheet and its
  /// profile; place, units and bounds are those above.
  DriveConfig drive{};
  double rest_counts = 0.0;  ///< where its drive was read last, at rest without power
};

enum class StrokeEnd : std::uint8_t {
  kNotYet,
  kDone,
  kStopped,    ///< by the engineer, or the enable line
  kFault,      ///< of the fault table
  kWrongWay,   ///< counts ran against the command
  kMovedAway,  ///< it moved before it was told to, as while the brake opened
};

struct StrokeReport {
  StrokeEnd end = StrokeEnd::kNotYet;
  Fault fault = Fault::kNone;
  FaultDetail detail;
  DriveReport drive;  ///< when it ended
  bool has_moved = false;
  bool is_seen_off = false;  ///< the drive said that it has no power, or it has started anew
  double start_counts = 0.0, end_counts = 0.0;
  StrokeValues values;
};

/// One motion of one joint: its drive is configured, waits for the enable line, switches on, the
/// brake opens, it moves and comes to rest, the brake closes, the drive is switched off and
/// released. Modes, brake, faults and their reactions are those of the daemon, of a robot with
/// this one drive; but whatever ends a motion ends the stroke, and nothing goes on by itself.
class Stroke {
 public:
  /// In a motion more than this, just missed, is kOverrun.
  static constexpr double kMaxGap_s = 0.03;

  /// Throws std::invalid_argument for settings that no drive can be given.
  Stroke(const HardwareConfig& hardware, const StrokePlan& plan, double period_s);

  void receive(int bus, std::span<const CanFrame> frames) noexcept { robot_.receive(bus, frames); }
  void update(const CommissionInput& input) noexcept;  ///< once a cycle, after all frames

  const FrameBatch& outbox(int bus) const noexcept { return robot_.outbox(bus); }
  void noteHeldBack(int bus) noexcept { robot_.noteHeldBack(bus); }
  bool isBrakeOpen() const noexcept { return brake_.is_open; }
  /// Off: what is still in the outbox releases the drive, and nothing follows.
  bool isFinished() const noexcept { return mode_.mode == Mode::kOff; }
  Mode mode() const noexcept { return mode_.mode; }
  const StrokeReport& report() const noexcept { return report_; }

 private:
  Fault judge(const CommissionInput& input) noexcept;
  Fault judgePlace() noexcept;
  bool runsWrongWay() const noexcept;
  void move(const CommissionInput& input, Mode before) noexcept;
  void begin() noexcept;
  DriveGoal goal() const noexcept;
  void updateBrakes() noexcept;
  void note() noexcept;

  StrokePlan plan_;
  double period_s_;
  bool has_enable_line_;
  CanRobot robot_;
  ModeConfig mode_config_;
  BrakeConfig brake_config_;
  ModeState mode_;
  BrakeState brake_;
  RobotInput seen_;
  StrokeMotion motion_;
  StrokeFigures figures_;
  StrokeReport report_;
  JointVector commanded_, velocity_;  ///< one entry
  double start_ = 0.0;                ///< where it began to move
  double time_s_ = 0.0;               ///< of the motion
  double origin_ = 0.0;               ///< from which the motion counts
  bool is_first_ = true;
  bool is_over_ = false;  ///< to be ended: done, or stopped
  bool was_stopped_ = false;
  bool has_brake_opened_ = false;
};

}  // namespace tactus
