#pragma once

#include <cstdint>
#include <type_traits>

#include "tactus/control/controller.h"
#include "tactus/control/robot.h"
#include "tactus/math/tool_motion.h"
#include "tactus/math/types.h"
#include "tactus/supervisor/mode.h"

namespace tactus {

/// Everything the log holds of one cycle, in the order of the columns of `tactus export`. Every
/// member is made of 8-byte words, so that the record has no padding and is copied as it lies;
/// of the arrays only as many entries count as the robot has joints and tactile modules and the
/// task components. record_fields.h names the members; a member without an entry there is not
/// logged, but gains.
struct CycleRecord {
  double t_s = 0.0;
  double force_sensor_N[kMaxTactileModules] = {};      ///< F_sen
  double contact_position_m[kMaxTactileModules] = {};  ///< along the link
  /// Unit force on the robot, module frame.
  double contact_dir_x[kMaxTactileModules] = {}, contact_dir_y[kMaxTactileModules] = {},
         contact_dir_z[kMaxTactileModules] = {};
  double force_contact_N = 0.0;
  double stiffness_N_per_m = 0.0;
  double stiffness_raw_N_per_m = 0.0;
  double gamma = 0.0;
  double k_n = 0.0, k_j = 0.0, k_t = 0.0;
  double x_dot_eff_m_per_s = 0.0;
  double u_n = 0.0, u_j = 0.0, u_t = 0.0;
  double q[kMaxJoints] = {};   ///< desired configuration at the start of the cycle, m or rad
  double dq[kMaxJoints] = {};  ///< the command, m/s or rad/s
  double w[kMaxTaskSize] = {}, wd[kMaxTaskSize] = {}, wd_dot[kMaxTaskSize] = {};
  std::uint64_t fault = 0;  ///< the number of a Fault
  std::int64_t wake_latency_ns = 0;
  std::int64_t step_ns = 0;
  double q_measured[kMaxJoints] = {};
  double tactile_force_y_N[kMaxTactileModules] = {}, tactile_force_z_N[kMaxTactileModules] = {};
  double tactile_moment_y_Nm[kMaxTactileModules] = {}, tactile_moment_z_Nm[kMaxTactileModules] = {};
  std::uint64_t tactile_sequence[kMaxTactileModules] = {};
  double tool_error_m[3] = {};  ///< desired minus actual position of the measured arm, base frame
  double task_time_s = 0.0;     ///< the task's clock, which stands still while the arm holds
  std::uint64_t mode = static_cast<std::uint64_t>(Mode::kRunning);  ///< the number of a Mode
  std::int64_t read_ns = 0;   ///< from waking to all frames and lines read; hardware only
  std::int64_t write_ns = 0;  ///< from the set-points to the last frame handed over; hardware only
  std::uint64_t missed_cycles = 0;  ///< skipped by the loop just before this one
  double path_time_s = 0.0;         ///< the reference's clock: task_time_s less the time it waited
  double tool_rotation_error_rad = 0.0;  ///< as tool_error_m; only for tasks with a rotation
  double tactile_moment_x_Nm[kMaxTactileModules] = {};  ///< 0 of modules that do not tell it
  // Of an arm that goes on without a tactile module, as ControllerOutput:
  std::uint64_t modules_lost = 0;  ///< bit i: module i
  double speed_share = 1.0;
  Gains gains;                 ///< of this cycle; the log has them where they change
  ToolMotionPlan tool_motion;  ///< of a task by command; logged like gains
};

static_assert(std::is_trivially_copyable_v<CycleRecord> && std::is_standard_layout_v<CycleRecord>);
static_assert(sizeof(CycleRecord) ==
              8 * (12 + 11 * kMaxTactileModules + 3 * kMaxJoints + 3 * kMaxTaskSize + 15) +
                  sizeof(Gains) + sizeof(ToolMotionPlan));

/// Copies one cycle into a record; wake_latency_ns and step_ns are left to the caller, who alone
/// knows a clock, and tool_rotation_error_rad. tool_error_m: see CycleRecord. Entries of arrays
/// beyond the robot's joints and modules and the task's components keep what they held.
void fillRecord(double t_s, const RobotInput& input, const Gains& gains,
                const ControllerOutput& output, const Vector3& tool_error_m,
                CycleRecord& record) noexcept;

/// F_sen of the module that feels most, of so many; 0 without one.
double largestForce_N(const CycleRecord& record, int modules) noexcept;

/// The controller's input of a logged cycle; `joints` entries of q_measured.
RobotInput recordedInput(const CycleRecord& record, int joints) noexcept;

}  // namespace tactus
