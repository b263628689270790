#pragma once

#include <optional>

#include "tactus/control/acceleration_law.h"
#include "tactus/control/approach_limit.h"
#include "tactus/control/contact_point.h"
#include "tactus/control/contact_transition.h"
#include "tactus/control/control_law.h"
#include "tactus/control/controller_config.h"
#include "tactus/control/friction_cone.h"
#include "tactus/control/joint_space_transition.h"
#include "tactus/control/motion.h"
#include "tactus/control/motion_gate.h"
#include "tactus/control/stiffness_estimator.h"

namespace tactus {

/// What the law reports of one cycle, in the paper's symbols; zero where a stage is absent.
struct ContactReport {
  double force_contact_N = 0.0;        ///< F_p
  double stiffness_N_per_m = 0.0;      ///< c
  double stiffness_raw_N_per_m = 0.0;  ///< c_raw
  double gamma = 0.0;
  double k_n = 0.0, k_j = 0.0, k_t = 0.0;  ///< (18), (19)
  double x_dot_eff_m_per_s = 0.0;          ///< (18)
  double u_n = 0.0, u_j = 0.0, u_t = 0.0;
};

struct ContactControllerState {
  ContactPointState contact;  ///< with a return speed: held at where it was lost
  /// Multi-space only (else empty): how fast the law moved the tool at last; zero without a return
  /// speed, which alone asks.
  TaskVector push;
  bool has_push = false;  ///< it may be other than zero
  ContactTransitionState transition;
  JointSpaceTransitionState joint_space_transition;  ///< instead, for joint space
  StiffnessEstimatorState estimator;
  ApproachLimitState approach;  ///< with an estimator of its own, for null_limit
  ControlLawState law;
  double cut_m_per_s = 0.0;          ///< of the retreat, by the limits of the last cycle
  double cut_by_rows_m_per_s = 0.0;  ///< likewise, by rows of joints near theirs
  bool keeps_joints = false;         ///< rows keep joints near their limits off them
  bool is_resting = false;           ///< the last cycle's command did not move the arm
};

/// The answer to contact: contact space, stiffness estimate, contact transition and law, added to
/// the motion that the task asks for.
class ContactController {
 public:
  /// config.force_control must be there, and one tactile module: the laws answer one contact.
  ContactController(const ControllerConfig& config, const ScaledVector& inv_sqrt_weights);

  ContactControllerState initialState() const;

  /// sensor: the newest contact point.
  void update(const Gains& gains, const TaskKinematics& kinematics, const ContactPointState& sensor,
              const CommandedMotion& commanded, const MotionGate& gate, double period_s,
              ContactControllerState& state, ContactReport& report, Motion& motion) const noexcept;

 private:
  struct Contact;

  /// The contact that the law uses: as read, or smoothed by a stage.
  const ContactPointState& follow(const Gains& gains, const ContactPointState& sensor,
                                  const TaskKinematics& kinematics,
                                  const CommandedMotion& commanded, double period_s,
                                  ContactControllerState& state) const noexcept;
  void estimate(const ForceGains& gains, const Contact& contact, const CommandedMotion& commanded,
                double period_s, ContactControllerState& state, ContactReport& report,
                ControlLawInput& input) const noexcept;
  void rest(const ForceGains& gains, const Contact& contact, bool is_at_rest, double period_s,
            ContactControllerState& state, ContactReport& report,
            ControlLawInput& input) const noexcept;
  Contact locate(const TaskKinematics& kinematics, const ContactPointState& point,
                 ScaledVector& a) const noexcept;
  void passContact(const ForceGains& gains, const Contact& contact, double period_s,
                   ContactControllerState& state, ContactReport& report,
                   ControlLawInput& input) const noexcept;
  void passJointSpaceContact(const Gains& gains, const TaskKinematics& kinematics,
                             const Contact& contact, double return_share, double period_s,
                             ContactControllerState& state, ContactReport& report,
                             ControlLawInput& input, Motion& motion) const noexcept;
  void addContactRows(const ForceGains& gains, const TaskKinematics& kinematics,
                      const ContactSpace& space, double F_p_N, const ApproachLimitState& approach,
                      SpeedRows& rows) const noexcept;
  /// The approach limit, with friction that of all corners of the cone, beside all else that is
  /// kept. Returns what stands for u_t.
  double limitRows(const ForceGains& gains, const TaskKinematics& kinematics,
                   const CommandedMotion& commanded, const ContactSpace& space, double F_p_N,
                   const MotionGate& gate, double period_s, ContactControllerState& state,
                   Motion& motion) const noexcept;
  /// Acceleration level: the least speed of the contact point in this cycle, on the way from its
  /// last one to v_least with k_v.
  double eased(const ForceGains& gains, const ContactSpace& space, const CommandedMotion& commanded,
               double period_s, double v_least) const noexcept;
  /// The law of the acceleration level. p_BaseContact: m; F_Base: F^.
  ControlLawOutput accelerate(const ForceGains& gains, const TaskKinematics& kinematics,
                              const Vector3& p_BaseContact, const Vector3& F_Base,
                              const ContactSpace& space, const CommandedMotion& commanded,
                              const ControlLawInput& input, double period_s, ControlLawState& state,
                              Motion& motion) const noexcept;
  /// beta_pull (w_d - w), which together with the correction of (2) stays within the return speeds.
  TaskVector pull(const Gains& gains, const PaddedTaskVector& error) const noexcept;

  SerialChain chain_;
  AttachedFrame link_;
  double initial_position_m_;
  TaskConfig task_;
  bool is_joint_space_;
  bool is_multi_space_;
  bool has_estimator_;
  ScaledVector inv_sqrt_weights_;
  ControlLaw law_;
  std::optional<AccelerationLaw> acceleration_law_;
  std::optional<ApproachLimit> approach_limit_;
  std::optional<FrictionCone> friction_cone_;  ///< with the approach limit alone
};

}  // namespace tactus
