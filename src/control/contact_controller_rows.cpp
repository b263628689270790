#include <algorithm>

#include "tactus/control/contact_controller.h"

/// The approach limit as rows, beside others.
namespace tactus {

void ContactController::addContactRows(const ForceGains& gains, const TaskKinematics& kinematics,
                                       const ContactSpace& space, double F_p_N,
                                       const ApproachLimitState& approach,
                                       SpeedRows& rows) const noexcept {
  double cosine = 1.0;
  if (friction_cone_) {
    const ContactPointState& contact = approach.smoother.contact;
    friction_cone_->add(chain_, kinematics, contact.direction,
                        friction_cone_->around({contact.position_m, contact.position_m}),
                        inv_sqrt_weights_, rows);
    cosine = friction_cone_->cosine();
  } else {
    rows.row[0].a_scaled = space.a_scaled;
    rows.row[0].a_task = space.a_task;
    rows.size = 1;
  }
  approach_limit_->limitRows(gains, F_p_N, cosine, 1.0, approach, 0, rows);
}

double ContactController::limitRows(const ForceGains& gains, const TaskKinematics& kinematics,
                                    const CommandedMotion& commanded, const ContactSpace& space,
                                    double F_p_N, const MotionGate& gate, double period_s,
                                    ContactControllerState& state, Motion& motion) const noexcept {
  state.cut_by_rows_m_per_s = 0.0;
  state.keeps_joints = false;
  const double memory = state.approach.memory_N_per_m;
  if (memory == 0.0 && !gate.clearance()) return 0.0;
  SpeedRows rows;
  rows.is_of_one_contact = true;
  if (memory > 0.0) addContactRows(gains, kinematics, space, F_p_N, state.approach, rows);
  if (acceleration_law_ && memory > 0.0) {
    double& v_max = rows.row[0].v_max_m_per_s;
    v_max = -eased(gains, space, commanded, period_s, -v_max);
  }
  const int corners = rows.size;
  const double in_contact = stiffnessInContact(gains, state.approach.estimator);
  const auto retreat = [&] {
    return dot(space.a_scaled, motion.v_scaled) + dot(space.a_task, motion.y, task_.size);
  };
  const double retreat_before = retreat();
  const RowVector l =
      gate.keep(commanded, kinematics, std::min(1.0, memory / in_contact), period_s, rows, motion);
  const double sum = l.head(corners).sum();
  state.keeps_joints = rows.size > corners;
  state.cut_by_rows_m_per_s = state.keeps_joints ? std::max(0.0, retreat_before - retreat()) : 0.0;
  state.approach.is_limiting = state.approach.is_limiting || sum > 0.0;
  return -sum;
}

}  // namespace tactus
