#include <algorithm>
#include <numbers>

#include "tactus/control/controller.h"

/// The way out of a contact in which a fault has stopped the arm.
namespace tactus {
namespace {

/// Between two samples, and until one that is there is read.
constexpr double kSampleTime_s = 0.005;
constexpr double kMaxWayBack_s = 0.25;
constexpr double kStandstill = 1e-6;  ///< m/s or rad/s
constexpr double kEstimateMargin = 2.0;
constexpr double kAssumptionMargin = 8.0;

bool isExcess(const TactileReading& reading) noexcept {
  return reading.fault == Fault::kTactileInvalid && reading.has_excess;
}

/// Not the last sample's: after a blow the module's filter tells of a push from the other side.
/// Behind that filter a reading does not jump: where a contact was felt before an excess, that
/// sample knows where it is, and a sensor that lies does not move the arm into it.
const ContactPointState& lastContact(const TactileReading& reading, double threshold_N) noexcept {
  const bool is_unknown = reading.hardest.force_N <= threshold_N;
  return is_unknown && isExcess(reading) ? reading.excess : reading.hardest;
}

}  // namespace

/// A contact may be as much softer than the law takes it for. What is assumed is the stiffest that
/// may be met; an estimate may be the stiffer, the more the arm swings.
double Controller::leastStiffness_N_per_m(const Gains& gains, int module,
                                          const ControllerState& state) const noexcept {
  const ContactControllerState& contact = state.contact;
  const ApproachLimitState& approach =
      several_contacts_ ? state.several.modules[module].approach : contact.approach;
  const double estimated =
      std::max(contact.estimator.stiffness_N_per_m, approach.estimator.stiffness_N_per_m);
  const double least = gains.force.assumed_stiffness_N_per_m / kAssumptionMargin;
  if (config_.force_control && config_.force_control->has_estimator && estimated > 0.0)
    return std::min(estimated / kEstimateMargin, least);
  return least;
}

/// From when the arm was where the last sample felt it: that sample's age, and what drives and
/// filter delay.
double Controller::untold_s(int module, const ControllerState& state) const noexcept {
  const double cutoff_rad_per_s =
      2.0 * std::numbers::pi * config_.tactile_modules[module].filter_cutoff_hz;
  // Of a Butterworth filter of third order 2 / w_c.
  return state.modules[module].age_s + 2.0 / cutoff_rad_per_s + config_.drive_lag_s + kSampleTime_s;
}

void Controller::beginRetreat(const Gains& gains, ControllerState& state) const noexcept {
  const JointVector velocity =
      state.fault == Fault::kNone ? state.velocity_before : state.retreat.velocity_at_fault;
  const bool has_moved = state.retreat.has_moved;
  ScaledVector way_out = state.retreat.way_out;
  if (!has_moved && joint_limit_avoidance_) way_out = wayOut(gains, state);
  state.retreat = {};
  state.retreat.has_moved = has_moved;
  state.retreat.way_out = way_out;
  state.retreat.velocity_at_fault = velocity;
  takePush(gains, state);
  if (state.retreat.has_push) return;
  // Where no push of late is left there is no contact; since then there may be.
  state.retreat.is_over = velocity.isZero(kStandstill);
  double longest_s = 0.0;
  for (int i = 0; i < modules(); ++i)
    if (!state.modules[i].is_lost) longest_s = std::max(longest_s, untold_s(i, state));
  startWayBack(std::min(kMaxWayBack_s, longest_s), state.retreat);
}

/// Of the module that presses most.
void Controller::takePush(const Gains& gains, ControllerState& state) const noexcept {
  RetreatState& retreat = state.retreat;
  const double threshold_N = std::max(gains.force.contact_threshold_N, kMinForceForDirection_N);
  double largest_N = threshold_N;
  for (int i = 0; i < modules(); ++i) {
    const ContactPointState& contact = lastContact(state.modules[i], threshold_N);
    if (contact.force_N <= largest_N) continue;
    largest_N = contact.force_N;
    retreat.module = i;
    retreat.push = contact;
    retreat.has_push = true;
    retreat.untold_s = untold_s(i, state);
    retreat.stiffness_N_per_m = leastStiffness_N_per_m(gains, i, state);
  }
}

/// d way / dt = row^T q_dot: J_p^T F^ of the point that moves on with its link, and of the push as
/// it was.
void Controller::computeRow(const ChainPose& pose, RetreatState& retreat) const noexcept {
  const AttachedFrame& link = config_.tactile_modules[retreat.module].link;
  const PlacedContact at = placed(pose, link, retreat.push);
  if (!retreat.is_placed) retreat.direction_Base = at.F_Base;
  applyPointJacobianTranspose(config_.chain, pose, link.joint, at.p_Base, retreat.direction_Base,
                              retreat.row);
  if (retreat.is_placed) return;
  retreat.is_placed = true;
  const JointVector& velocity = retreat.velocity_at_fault;
  const double speed_m_per_s = retreat.row.head(velocity.size()).dot(velocity);
  startRetreat({retreat.push.force_N, retreat.stiffness_N_per_m, speed_m_per_s, retreat.untold_s},
               retreat);
}

RetreatReading Controller::readForRetreat(const ControllerState& state) const noexcept {
  if (state.retreat.module < 0) return {};
  const TactileReading& reading = state.modules[state.retreat.module];
  const bool is_readable = reading.fault == Fault::kNone || isExcess(reading);
  return {reading.age_s == 0.0, is_readable, reading.age_s,
          config_.tactile_modules[state.retreat.module].max_sample_age_s,
          isExcess(reading) ? reading.excess.force_N : reading.contact.force_N};
}

void Controller::leaveContact(const Gains& gains, const TaskKinematics& kinematics, double period_s,
                              ControllerState& state, JointVector& velocity) const noexcept {
  RetreatState& retreat = state.retreat;
  if (!retreat.has_push) takePush(gains, state);
  if (retreat.has_push) computeRow(kinematics.pose, retreat);
  const double speed =
      retreatSpeed(readForRetreat(state), gains.force.contact_threshold_N, period_s, retreat);
  if (speed == 0.0) return;
  retreat.has_moved = true;
  if (retreat.has_push) {
    velocity = retreatVelocity(gains, kinematics, speed, period_s, state);
  } else {
    velocity = -speed * retreat.velocity_at_fault;
    retreat.row = scaled(velocity, ScaledVector::Ones()) / velocity.squaredNorm();
  }
}

/// The task, whose time stands still, is given up for as much as the null space cannot do.
JointVector Controller::retreatVelocity(const Gains& gains, const TaskKinematics& kinematics,
                                        double speed_m_per_s, double period_s,
                                        const ControllerState& state) const noexcept {
  SpeedRows rows;
  SpeedRow& contact = rows.row[rows.size++];
  contact.a_scaled = inv_sqrt_weights_.cwiseProduct(state.retreat.row);
  contact.a_task = kinematics.pseudoinverse.project(contact.a_scaled);
  contact.v_max_m_per_s = -speed_m_per_s;
  contact.presence = 1.0;
  contact.damping_N_s_per_m = gains.force.time_constant_s * state.retreat.stiffness_N_per_m;
  if (several_contacts_)
    several_contacts_->addRows(gains.force, kinematics, state.retreat.module, state.several, rows);
  Motion motion;
  motion.y.setZero();
  motion.v_scaled.setZero();
  gate_.keep({state.q_desired, state.velocity_before, true}, kinematics, 1.0, period_s, rows,
             motion);
  motion.v_scaled += kinematics.pseudoinverse.expand(motion.y);
  motion.v_scaled.array() *= inv_sqrt_weights_.array();
  return motion.v_scaled.head(config_.chain.size());
}

}  // namespace tactus
