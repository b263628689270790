#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "tactus/canopen/can_robot.h"
#include "tactus/control/controller.h"
#include "tactus/supervisor/brake.h"
#include "tactus/supervisor/cycle_record.h"
#include "tactus/supervisor/gain_change.h"
#include "tactus/supervisor/joint_places.h"
#include "tactus/supervisor/line_states.h"
#include "tactus/supervisor/mode.h"
#include "tactus/supervisor/mode_report.h"
#include "tactus/supervisor/tool_orders.h"

namespace tactus {

/// What the world outside the frames says to a cycle.
struct CycleInput {
  bool stop_requested = false;
  GpioInputs lines;
  bool are_lines_lost = false;                ///< a GPIO line could not be read or written
  std::array<Fault, kMaxBuses> bus_faults{};  ///< of each bus's monitor
  int missed_cycles = 0;                      ///< skipped just before this one
  int late_in_a_row = 0;                      ///< this one included
  bool has_forbidden_call = false;            ///< the loop left its list of system calls
};

/// One cycle of the daemon between frames in and frames out: read - judge - control - limit -
/// write, and between cycles prepare. Knows no socket, no line and no clock, so that the whole of
/// it runs in virtual time, too.
class ControlCycle {
 public:
  ControlCycle(const ControllerConfig& controller, const HardwareConfig& hardware, double period_s);

  /// What the next cycles are given, as Controller::update() wants them; at first the config's.
  /// Before update(), or after fill().
  void tune(const Gains& gains) noexcept { gains_ = gains; }
  /// Leads them there over the next cycles. After fill().
  void order(const GainOrder& order) noexcept { gain_change_.order(order); }
  const GainReport& gainReport() const noexcept { return gain_change_.report(); }
  /// Leads the tool there; only for tasks by command. After fill().
  void order(const ToolOrder& order) noexcept { tool_orders_->order(order); }
  const ToolReport* toolReport() const noexcept {
    return tool_orders_ ? &tool_orders_->report() : nullptr;
  }
  /// Only for tasks by command. After prepare().
  void fill(ToolSight& sight) const noexcept;

  void receive(int bus, std::span<const CanFrame> frames) noexcept { robot_.receive(bus, frames); }
  void update(const CycleInput& input) noexcept;
  /// Does ahead, while frames travel and drives move, what the next cycle needs and already can
  /// know. May be left out. After fill(), as the next cycle's gains are no longer this one's.
  void prepare() noexcept;
  const FrameBatch& outbox(int bus) const noexcept { return robot_.outbox(bus); }
  void noteHeldBack(int bus) noexcept { robot_.noteHeldBack(bus); }
  const CanFrame& probe() const noexcept { return robot_.probe(); }
  GpioOutputs lines() const noexcept;

  const CanRobot& robot() const noexcept { return robot_; }
  const ModeReport& report() const noexcept { return report_; }
  WayOn wayOn() const noexcept { return way_on_; }
  bool isFinished() const noexcept { return mode_.mode == Mode::kOff; }
  /// From the first cycle of motion on, every cycle is recorded.
  bool isRecorded() const noexcept { return is_started_; }
  /// With all of this cycle but the times of its phases, which are the caller's to know.
  void fill(CycleRecord& record) const noexcept;
  /// Cycles in which the task went on.
  long long taskCycles() const noexcept { return task_cycles_; }

 private:
  Fault judge(const CycleInput& input) noexcept;
  Fault judgeBuses(const CycleInput& input) noexcept;
  Fault judgeDrives() noexcept;
  bool isHeldByDrives() const noexcept;
  int firstNotFollowing() const noexcept;
  void judgeTimeLimit(Mode mode) noexcept;
  Fault judgeTactile() noexcept;
  Fault judgeModule(int module) noexcept;
  bool isLeftOut(int module, Fault fault) const noexcept;
  void withholdSamples(
      int missed_cycles,
      const std::array<TactileSample, kMaxTactileModules>& samples_before) noexcept;
  Fault judgeController() noexcept;
  ModeInput modeInput(const CycleInput& input, Fault fault) noexcept;
  bool areConfigured() const noexcept;
  void rememberPlaces() noexcept;
  void coast(int missed_cycles) noexcept;
  int modules() const noexcept { return static_cast<int>(robot_.tactileModules().size()); }
  FaultDetail sampleAge(int module) const noexcept;
  bool hasFreshSample(int module) const noexcept;
  bool isReady(int module) const noexcept;
  void begin() noexcept;
  void goOnWithOrders() noexcept;
  void forgetOrders() noexcept;
  void goOnWithGains() noexcept;
  void goOnWithTool() noexcept;
  void startTares() noexcept;
  void repeatRefusedTares() noexcept;
  void noteCulprit(int missed_cycles) noexcept;
  void control(const CycleInput& input, Mode before) noexcept;
  double time_s() const noexcept { return static_cast<double>(cycles_) * period_s_; }
  long long nextTaskCycle() const noexcept {
    return task_cycles_ + (mode_.mode == Mode::kRunning ? 1 : 0);
  }
  double nextPathTime_s() const noexcept;
  double toolProgress() const noexcept;
  bool isRunning() const noexcept { return is_started_ && mode_.mode == Mode::kRunning; }
  Pose toolPose() const noexcept;
  double taskTime_s() const noexcept { return static_cast<double>(task_cycles_) * period_s_; }
  DriveGoal driveGoal() const noexcept;
  void updateBrakes() noexcept;

  /// What judge() found, and of whom it speaks.
  struct Judged {
    Fault fault = Fault::kNone;
    int joint = -1;
    int bus = -1;
    FaultDetail detail;
  };

  Controller controller_;
  Gains gains_;
  GainChange gain_change_;
  std::optional<ToolOrders> tool_orders_;  ///< of tasks by command
  bool has_next_orders_ = false;
  std::uint32_t runs_ = 0;  ///< how often the arm has begun to run
  CanRobot robot_;
  JointPlaces places_;
  std::array<const char*, kMaxJoints> joint_units_;
  double period_s_;
  int max_late_cycles_;
  bool has_enable_line_;
  ModeConfig mode_config_;
  BrakeConfig brake_config_;
  ModeState mode_;
  BrakeState brake_;
  bool have_brakes_opened_ = false;  ///< since drives were off: joints may need them to close
  Judged judged_;
  ModeReport report_;
  WayOn way_on_;
  ControllerState state_;
  PreparedCycle prepared_;
  /// With which the controller's state began.
  struct SampleAtStart {
    std::uint32_t sequence = 0;
    double age_s = 0.0;
  };
  std::array<SampleAtStart, kMaxTactileModules> samples_at_start_;
  /// Samples of a module that said of late that its cable is broken, and that the arm goes on
  /// without; or that came while the loop paused.
  struct Withheld {
    int cycles = 0;              ///< to go; the last one lasts until a new sample
    std::uint32_t sequence = 0;  ///< of the newest one
  };
  std::array<Withheld, kMaxTactileModules> withheld_;
  RobotInput input_;
  ControllerOutput output_;
  bool is_started_ = false;  ///< the controller has a state
  bool is_first_ = true;
  int missed_cycles_ = 0;  ///< skipped just before this one
  bool heartbeat_ = false;
  long long cycles_ = 0;       ///< since the first cycle of motion, missed ones included
  long long task_cycles_ = 0;  ///< of these, those in which the task's clock ran
};

}  // namespace tactus
