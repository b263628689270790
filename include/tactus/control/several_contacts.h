#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tactus/control/approach_limit.h"
#include "tactus/control/contact_controller.h"
#include "tactus/control/contact_transition.h"
#include "tactus/control/friction_cone.h"
#include "tactus/control/motion_gate.h"
#include "tactus/control/null_speed_limit.h"
#include "tactus/control/stiffness_centre.h"
#include "tactus/control/tactile_reading.h"

namespace tactus {

/// What is known of the contact of one module.
struct ModuleContactState {
  ApproachLimitState approach;
  ContactTransitionState transition;  ///< gamma alone: is it still the contact that it was?
  StiffnessCentreState centre;        ///< of a law that asks for it
  bool is_lost = false;               ///< since it pressed
  double haste = 1.0;                 ///< of forgetting: halved each time that it was lost in vain
};

struct SeveralContactsState {
  std::array<ModuleContactState, kMaxTactileModules> modules;
  NullSpeedLimits null_speed;
};

// clang-format off: equations
/// null_limit for robots with several tactile modules, each with contacts of its own: rows of two
/// levels, with the force F_i, stiffness m_i and way ahead e_i of each as in approach_limit.h.
///   level 1, null space alone:  a_ij^T q_dot >= (F_i - F_th + m_i e_i) / (T m_i)
///            holds contacts at F_th, from above and below; limited to the null-space speed
///   level 2, task, too:         a_ij^T q_dot >= -v_max,i,   the approach limit of each
///            a_ij: a_i, or the corners of the friction cone
/// As a module tells of two contacts the resultant alone, both levels have the same row a second
/// time towards the centre of stiffness, where that is elsewhere beyond doubt; or, as LimitAt says,
/// both rows at the ends of the module, or the resultant's alone. A contact is there while m_i > 0.
/// Nothing else is remembered: no integral, no feedforward. Derived in docs/gate.md.
// clang-format on
class SeveralContacts {
 public:
  /// config.force_control must be there, with null_limit, and see hasContactRows().
  SeveralContacts(const ControllerConfig& config, const ScaledVector& inv_sqrt_weights);

  SeveralContactsState initialState() const noexcept;

  /// readings: of each module. The report is of the contact that presses most.
  void update(const Gains& gains, const TaskKinematics& kinematics,
              const std::array<TactileReading, kMaxTactileModules>& readings,
              const CommandedMotion& commanded, const MotionGate& gate, double period_s,
              SeveralContactsState& state, ContactReport& report, Motion& motion) const noexcept;

  /// The second level's rows of all contacts but that of one module; -1: of all.
  void addRows(const ForceGains& gains, const TaskKinematics& kinematics, int without_module,
               const SeveralContactsState& state, SpeedRows& rows) const noexcept;

 private:
  struct Module {
    AttachedFrame link;
    ApproachLimit limit;
    std::optional<FrictionCone> cone;
    std::optional<StiffnessCentre> centre;
    double length_m;

    double cosine() const { return cone ? cone->cosine() : 1.0; }
  };
  struct Place;

  void locate(const TaskKinematics& kinematics, const Module& module,
              const ContactPointState& point, Place& place) const noexcept;
  void project(const TaskKinematics& kinematics, const ScaledVector& a,
               SpeedRow& row) const noexcept;
  void addRowAt(const TaskKinematics& kinematics, const Module& module, ContactPointState point,
                double position_m, SpeedRows& rows) const noexcept;
  void addPlaces(const TaskKinematics& kinematics, const Module& module,
                 const ModuleContactState& state, const Place& place,
                 SpeedRows& rows) const noexcept;
  void sense(const Gains& gains, const TaskKinematics& kinematics, const TactileReading& reading,
             const CommandedMotion& commanded, double period_s, const Module& module,
             ModuleContactState& state, Place& place) const noexcept;
  void addRow(const ForceGains& gains, const TaskKinematics& kinematics, const Module& module,
              const ModuleContactState& state, const Place& place, SpeedRows& rows) const noexcept;
  double holdInNullSpace(const ForceGains& gains, const SpeedRows& rows, const RowVector& v_hold,
                         int contacts, RowProblem& problem, NullSpeedLimits& limits,
                         Motion& motion) const noexcept;

  SerialChain chain_;
  int task_size_;
  bool is_at_ends_;
  ScaledVector inv_sqrt_weights_;
  NullSpeedLimit null_speed_limit_;
  std::vector<Module> modules_;
};

}  // namespace tactus
