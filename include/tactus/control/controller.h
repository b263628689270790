#pragma once

#include <cstdint>
#include <optional>

#include "tactus/control/command_limiter.h"
#include "tactus/control/contact_point.h"
#include "tactus/control/contact_transition.h"
#include "tactus/control/control_law.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/joint_limit_avoidance.h"
#include "tactus/control/joint_space_transition.h"
#include "tactus/control/robot.h"
#include "tactus/control/stiffness_estimator.h"

namespace tactus {

/// What a controller reports of one cycle, in the paper's symbols; zero where a stage is absent.
struct ContactReport {
  double force_sensor_N = 0.0;                  ///< F_sen
  double contact_position_m = 0.0;              ///< along the link
  Vector3 contact_direction = Vector3::Zero();  ///< F^, unit force on the robot, module frame
  double force_contact_N = 0.0;                 ///< F_p
  double stiffness_N_per_m = 0.0;               ///< c
  double stiffness_raw_N_per_m = 0.0;           ///< c_raw
  double gamma = 0.0;
  double k_n = 0.0, k_j = 0.0, k_t = 0.0;  ///< (18), (19)
  double x_dot_eff_m_per_s = 0.0;          ///< (18)
  double u_n = 0.0, u_j = 0.0, u_t = 0.0;
};

/// Why a controller has stopped following its task. Every fault has one reaction: the command ramps
/// to rest within the acceleration limits and stays there.
enum class Fault : std::uint8_t {
  kNone = 0,
  kTactileInvalid = 1,    ///< reading not finite or beyond the module's range
  kTactileStale = 2,      ///< no new sample for longer than max_sample_age_s
  kCommandNotFinite = 3,  ///< the law produced a number that is none
};

const char* faultName(Fault fault) noexcept;

/// What one cycle computes.
struct ControllerOutput {
  JointVector velocity;        ///< the command, m/s or rad/s: finite and within all limits
  JointVector q_desired;       ///< the desired configuration this cycle started from, m or rad
  TaskVector w, w_d, w_d_dot;  ///< of the desired configuration; m, rad, m/s, rad/s
  ContactReport contact;
  Fault fault = Fault::kNone;
};

/// Everything that a controller remembers from one cycle to the next.
struct ControllerState {
  JointVector q_desired;        ///< m or rad
  JointVector velocity_before;  ///< previous command
  Fault fault = Fault::kNone;   ///< latched
  std::uint32_t sample_sequence = 0;
  double sample_age_s = 0.0;
  ContactPointState contact_point;
  ContactTransitionState transition;
  JointSpaceTransitionState joint_space_transition;  ///< instead, for joint space
  StiffnessEstimatorState estimator;
  ControlLawState law;
};

/// One cycle of the paper: kinematics of the desired configuration, contact, law and limits. The
/// output is a pure function of config, state, input, time and period, to the bit.
class Controller {
 public:
  explicit Controller(const ControllerConfig& config);

  ControllerState initialState() const;

  /// One cycle. t_s: time since the start of the run; period_s: time to the next cycle, > 0.
  void update(const RobotInput& input, double t_s, double period_s, ControllerState& state,
              ControllerOutput& output) const noexcept;

 private:
  struct Kinematics;
  struct Motion;
  struct Contact;

  void computeKinematics(double t_s, const ControllerState& state, Kinematics& kinematics,
                         ControllerOutput& output) const noexcept;
  void avoidJointLimits(const Kinematics& kinematics, const ControllerState& state,
                        Motion& motion) const noexcept;
  Fault readTactileModule(const RobotInput& input, double period_s,
                          ControllerState& state) const noexcept;
  void locate(const Kinematics& kinematics, const ContactPointState& point,
              Contact& contact) const noexcept;
  /// Adds the contact controller's part to the motion.
  void answerContact(const Kinematics& kinematics, double period_s, ControllerState& state,
                     ContactReport& report, Motion& motion) const noexcept;
  void passTransition(const Contact& contact, double period_s, ControllerState& state,
                      ContactReport& report, ControlLawInput& law_input) const noexcept;
  void passJointSpaceTransition(const Kinematics& kinematics, const Contact& contact,
                                double period_s, ControllerState& state, ContactReport& report,
                                ControlLawInput& law_input, Motion& motion) const noexcept;
  void limit(double period_s, ControllerState& state, ControllerOutput& output) const noexcept;

  ControllerConfig config_;
  Trajectory trajectory_;
  ScaledVector inv_sqrt_weights_;  ///< diagonal of W^-1/2
  CommandLimiter limiter_;
  std::optional<JointLimitAvoidance> joint_limit_avoidance_;
  std::optional<ControlLaw> law_;
  std::optional<ContactTransition> transition_;
  std::optional<JointSpaceTransition> joint_space_transition_;
  std::optional<StiffnessEstimator> estimator_;
};

}  // namespace tactus
