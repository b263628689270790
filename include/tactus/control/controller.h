#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tactus/control/command_limiter.h"
#include "tactus/control/contact_controller.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/fault.h"
#include "tactus/control/joint_limit_avoidance.h"
#include "tactus/control/motion.h"
#include "tactus/control/motion_gate.h"
#include "tactus/control/posture.h"
#include "tactus/control/retreat.h"
#include "tactus/control/robot.h"
#include "tactus/control/several_contacts.h"
#include "tactus/control/tactile_reading.h"
#include "tactus/math/velocity_product.h"

namespace tactus {

/// What one cycle computes.
struct ControllerOutput {
  JointVector velocity;        ///< the command, m/s or rad/s: finite and within all limits
  JointVector q_desired;       ///< the desired configuration this cycle started from, m or rad
  TaskVector w, w_d, w_d_dot;  ///< of the desired configuration; m, rad, m/s, rad/s
  TaskVector error;            ///< w_d - w; of rotations the vector of R_d R^T
  double path_time_s = 0.0;    ///< of the reference: the task's time less the time it waited
  int modules = 0;             ///< entries of `sensed` that count
  std::array<ContactPointState, kMaxTactileModules> sensed;  ///< as each module says
  ContactReport contact;
  std::uint64_t modules_lost = 0;  ///< bit i: the arm goes on without module i
  double speed_share = 1.0;        ///< in this cycle, of an arm that goes on without a module
  Fault fault = Fault::kNone;
  FaultDetail fault_detail;  ///< of the fault; set in its first cycle, then left alone
};

/// Everything that a controller remembers from one cycle to the next.
struct ControllerState {
  JointVector q_desired;        ///< m or rad
  JointVector velocity_before;  ///< previous command
  Fault fault = Fault::kNone;   ///< latched; while it is set the command ramps to rest
  bool is_stopping = false;     ///< set by the caller: ramp to rest and stay there
  double waited_s = 0.0;        ///< how far the reference is behind the task's time
  double progress = 1.0;        ///< of the reference in the last cycle: 1 on time, 0 at rest
  double return_share = 1.0;    ///< of beta and more; grows from 0 after restart()
  /// Out of joint limits' zones, as Motion::v_scaled: before the last restart(), and what came to
  /// it by the place where the arm stands since.
  ScaledVector way_out_before = ScaledVector::Zero(), way_out_added = ScaledVector::Zero();
  bool is_leaning = false;   ///< on something, where it stands since
  bool has_leaned = false;   ///< likewise, when it was held last
  double speed_share = 1.0;  ///< of all but answers to contacts; less without a tactile module
  std::array<TactileReading, kMaxTactileModules> modules;
  ContactControllerState contact;
  SeveralContactsState several;  ///< instead, see hasContactRows()
  JointLimitZones zones;         ///< of the last gains
  RetreatState retreat;
  /// Of tasks by command alone: the reference, by its clock. Set by the caller between two cycles,
  /// before prepare().
  std::optional<ToolMotion> tool_motion;

  bool mayMove() const noexcept { return fault == Fault::kNone && !is_stopping; }
};

/// The part of a cycle that needs no sensor: kinematics, factorisation and joint-limit cost of the
/// commanded configuration, computed while the drives still carry out the previous command.
struct PreparedCycle {
  /// For this time of the reference only; NaN: for none.
  double path_time_s = std::numeric_limits<double>::quiet_NaN();
  JointVector q_desired;  ///< and this configuration
  TaskVector push;        ///< and this push of the law, see TaskConfig
  double return_share = 1.0;
  bool is_leaning = false;
  TaskGains task_gains;  ///< and these gains
  JointLimitAvoidanceGains limit_gains;
  PostureGains posture_gains;
  TaskKinematics kinematics;
  Motion motion;  ///< of task, joint limits and clearance, without contact
  PaddedTaskVector w, w_d_dot;
  Vector3 rotation_vector_d;  ///< of the reference; only for tasks with a rotation, rad
  double progress = 1.0;      ///< of the reference, by how far the tool lags
};

/// One cycle of the paper: kinematics of the desired configuration, contact, law and limits. The
/// output is a pure function of structure, state, input, gains, time and period, to the bit.
class Controller {
 public:
  explicit Controller(const ControllerConfig& config);

  const ControllerConfig& config() const noexcept { return config_; }
  /// The config's, for whoever does not tune.
  const Gains& initialGains() const noexcept { return config_.gains; }

  ControllerState initialState() const { return initialState(config_.q_start); }
  /// For an arm that stands at q, near the configured start, m or rad.
  ControllerState initialState(const JointVector& q) const;

  /// For an arm that its drives stop by themselves: forgets the contact, and will return to its
  /// path gently (see return_speed.h); remembers the newest samples with their age, and where
  /// the path has got to.
  void restart(const Gains& gains, ControllerState& state) const noexcept;
  /// For an arm that stands at q, wherever it was commanded to be, m or rad.
  void place(const JointVector& q, const Gains& gains, ControllerState& state) const noexcept;

  /// For an arm that was placed and begins to move: led by a cost it does so gently, see
  /// return_speed.h, and from beside the configured start it returns to its path gently, as after
  /// restart().
  void begin(ControllerState& state) const noexcept;

  /// For an arm that a tactile fault takes from its task, with is_stopping: out of the contact, or
  /// back the way it came, until state.retreat.is_over; see retreat.h.
  void beginRetreat(const Gains& gains, ControllerState& state) const noexcept;
  /// For an arm that runs and is held: remembers whether it leans on something.
  void hold(const Gains& gains, ControllerState& state) const noexcept;
  /// For an arm that goes on where a hold or a retreat has left it, led gently by costs if it is
  /// free: see return_speed.h. If that was after a retreat, or its task is gone that its law
  /// opposed, it returns to its path as after restart().
  void goOn(const Gains& gains, ControllerState& state) const noexcept;

  /// For a cycle in which the controller has nothing to do: only samples are taken over, or age.
  void watchSensors(const RobotInput& input, double period_s,
                    ControllerState& state) const noexcept;
  /// The age of a module's sample in this input, a period after the last cycle, and its limit.
  FaultDetail sampleAge(int module, const RobotInput& input, double period_s,
                        const ControllerState& state) const noexcept;

  /// Whether the arm goes on, slowly, if nothing more comes from this module.
  bool goesOnWithout(int module, const Gains& gains, const ControllerState& state) const noexcept;

  /// For cycles that were missed: the drives kept the last command for as long, and the reference
  /// its progress. A ramp to rest is no longer for them: what it lacks comes with the next command.
  void coast(int missed_cycles, double period_s, ControllerState& state) const noexcept;

  /// One cycle. gains: within the ranges of their keys and fit for each other (findGainProblem() of
  /// scene says so), others each cycle if need be; t_s: the task's time, which goes on by period_s
  /// > 0 to the next cycle, or stands still while state.is_stopping.
  void update(const RobotInput& input, const Gains& gains, double t_s, double period_s,
              ControllerState& state, ControllerOutput& output) const noexcept;

  /// Does ahead what update() will need at t_s if state and gains are still the same then. Of the
  /// state changes only what is known of the gains.
  void prepare(const Gains& gains, double t_s, ControllerState& state,
               PreparedCycle& prepared) const noexcept;

  /// The same to the bit, but takes what is prepared, if it is for this time, state and gains, and
  /// uses it up. Between sensor and command only the contact is left to compute.
  void update(const RobotInput& input, const Gains& gains, double t_s, double period_s,
              PreparedCycle& prepared, ControllerState& state,
              ControllerOutput& output) const noexcept;

 private:
  void computeMotion(const Gains& gains, double path_time_s, ControllerState& state,
                     PreparedCycle& prepared) const noexcept;
  void respond(const RobotInput& input, const Gains& gains, double period_s,
               PreparedCycle& prepared, ControllerState& state,
               ControllerOutput& output) const noexcept;
  ToolAcceleration referenceAcceleration(double path_time_s,
                                         const ControllerState& state) const noexcept;
  void computeKinematics(double path_time_s, const ControllerState& state,
                         PreparedCycle& prepared) const noexcept;
  void computeTaskMotion(const TaskGains& gains, const ControllerState& state,
                         PreparedCycle& prepared) const noexcept;
  ToolReference referenceAt(double path_time_s, const ControllerState& state) const noexcept;
  Vector3 keepPartOfRotation(const ChainPose& pose, const Vector3& phi, const Vector3& omega_d,
                             ScaledJacobian& J) const noexcept;
  Vector3 partOfRotationAcceleration(double path_time_s, double progress, const Vector3& alpha_d,
                                     const VelocityProduct& curvature, const ChainPose& pose,
                                     const ControllerState& state) const noexcept;
  /// Of joint limits and posture together.
  JointLimitCost costAt(const JointVector& q, const Gains& gains,
                        ControllerState& state) const noexcept;
  FreeAcceleration freeAcceleration(const Gains& gains, double path_time_s, double period_s,
                                    const PreparedCycle& prepared,
                                    ControllerState& state) const noexcept;
  ScaledVector wayOut(const Gains& gains, ControllerState& state) const noexcept;
  bool leans(const Gains& gains, const ControllerState& state) const noexcept;
  bool isLed(const ScaledVector& way_out, const ControllerState& state) const noexcept;
  bool isLedAway() const noexcept;
  void bringBackSoon(const ScaledVector& way_out, ControllerState& state) const noexcept;
  void leadAnew(const Gains& gains, bool is_leaning, ControllerState& state) const noexcept;
  int modules() const noexcept { return static_cast<int>(config_.tactile_modules.size()); }
  Fault read(int module, const RobotInput& input, double period_s,
             TactileReading& reading) const noexcept;
  void sense(const RobotInput& input, const Gains& gains, double period_s, PreparedCycle& prepared,
             ControllerState& state, ControllerOutput& output) const noexcept;
  void answerContact(const Gains& gains, const TaskKinematics& kinematics,
                     const FreeAcceleration& free, double period_s, ControllerState& state,
                     ControllerOutput& output, Motion& motion) const noexcept;
  using ModuleFaults = std::array<Fault, kMaxTactileModules>;
  void goOnWithoutLost(const Gains& gains, double period_s, ModuleFaults& faults,
                       ControllerState& state, ControllerOutput& output) const noexcept;
  double speedShareAfter(double duration_s, const ControllerState& state) const noexcept;
  void judgeModules(const Gains& gains, double period_s, ModuleFaults& faults,
                    PreparedCycle& prepared, ControllerState& state,
                    ControllerOutput& output) const noexcept;
  int newlyFaulty(const ModuleFaults& faults, const ControllerState& state) const noexcept;
  static void slowDown(double speed_share, PreparedCycle& prepared) noexcept;
  void boundSpeeds(double speed_share, JointVector& velocity) const noexcept;
  double leastStiffness_N_per_m(const Gains& gains, int module,
                                const ControllerState& state) const noexcept;
  double untold_s(int module, const ControllerState& state) const noexcept;
  void takePush(const Gains& gains, ControllerState& state) const noexcept;
  void computeRow(const ChainPose& pose, RetreatState& retreat) const noexcept;
  RetreatReading readForRetreat(const ControllerState& state) const noexcept;
  void leaveContact(const Gains& gains, const TaskKinematics& kinematics, double period_s,
                    ControllerState& state, JointVector& velocity) const noexcept;
  JointVector retreatVelocity(const Gains& gains, const TaskKinematics& kinematics,
                              double speed_m_per_s, double period_s,
                              const ControllerState& state) const noexcept;
  void lookAround(const ControllerState& state, PreparedCycle& prepared) const noexcept;
  double keepClear(const TaskKinematics& kinematics, double period_s, const ControllerState& state,
                   Motion& motion) const noexcept;
  FaultDetail notFinite(const Motion& motion) const noexcept;
  void limit(const PreparedCycle& prepared, double period_s, ControllerState& state,
             ControllerOutput& output) const noexcept;
  bool admits(const PreparedCycle& prepared, double period_s, const ControllerState& state,
              const JointVector& velocity) const noexcept;
  void cut(const PreparedCycle& prepared, double period_s, ControllerState& state,
           ControllerOutput& output) const noexcept;
  void passTime(double duration_s, ControllerState& state) const noexcept;

  ControllerConfig config_;
  Trajectory trajectory_;
  ScaledVector inv_sqrt_weights_;  ///< diagonal of W^-1/2
  bool has_rotation_;
  bool has_part_of_rotation_;  ///< one or two of its three components
  bool is_acceleration_level_;
  CommandLimiter limiter_;
  MotionGate gate_;
  std::vector<CoverCompensation> covers_;  ///< one a module, or none
  std::optional<JointLimitAvoidance> joint_limit_avoidance_;
  std::optional<Posture> posture_;
  std::optional<ContactController> contact_controller_;
  std::optional<SeveralContacts> several_contacts_;  ///< instead, see hasContactRows()
};

}  // namespace tactus
