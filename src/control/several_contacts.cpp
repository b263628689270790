#include "tactus/control/several_contacts.h"

#include <algorithm>

namespace tactus {
namespace {

static_assert(4 * kMaxTactileModules + kMaxNearBodies + kMaxJoints <= kMaxRows,
              "room for the corners of all contacts, and for what is kept beside them");

/// Of T, in which m is forgotten. As fast as T, a link that an overshoot has sent away would come
/// back before it is slow enough, and bounce: the way back takes T for each F_th of overshoot.
constexpr double kFading = 0.2;

/// A link that comes back to the contact that it has lost, before it went elsewhere, had not
/// remembered it for long enough.
constexpr double kLeastHaste = 1.0 / 64.0;
/// Of the products of a cycle the first level takes no more: the second one has to hold.
constexpr double kFirstShare = 0.5;
constexpr double kElsewhere = 0.5;  ///< of the distance where a contact is another

/// How fast m fades; 0 while the contact is felt.
double fading(const ForceGains& gains, double F_p_N, const Vector3& p_Base,
              ModuleContactState& state) noexcept {
  if (F_p_N == 0.0 && state.approach.smoother.contact.force_N <= gains.transition.release_force_N) {
    state.is_lost = true;
    return kFading * std::max(state.haste, 1.0 - state.transition.gamma);
  }
  if (F_p_N > 0.0 && state.is_lost) {
    state.is_lost = false;
    const double apart_m = (p_Base - state.transition.p_BaseLost).norm();
    const bool is_back =
        state.transition.touched && apart_m < kElsewhere * gains.transition.distance_m;
    state.haste = is_back ? std::max(0.5 * state.haste, kLeastHaste) : 1.0;
  }
  return 0.0;
}

double contactForce_N(const ForceGains& gains, const ModuleContactState& state) noexcept {
  return std::max(0.0, state.approach.smoother.contact.force_N - gains.contact_threshold_N);
}

/// 1 in contact, then less and less.
double presence(const ForceGains& gains, const ApproachLimitState& state) noexcept {
  return std::min(1.0, state.memory_N_per_m / stiffnessInContact(gains, state.estimator));
}

/// The speeds that the first level gives the rows of a contact.
void addHoldSpeeds(const ForceGains& gains, const ApproachLimitState& state, double cosine,
                   int first, const SpeedRows& rows, RowVector& v_hold) noexcept {
  const double m = state.memory_N_per_m;
  const double F_left_N =
      gains.contact_threshold_N - state.smoother.contact.force_N - m * state.way_ahead_m;
  const double v_m_per_s = cosine * (F_left_N / (gains.time_constant_s * m));
  for (int i = first; i < rows.size; ++i) v_hold[i] = v_m_per_s;
}

void tell(const ForceGains& gains, const ModuleContactState& state,
          ContactReport& report) noexcept {
  report.force_contact_N = contactForce_N(gains, state);
  report.stiffness_N_per_m = state.approach.estimator.stiffness_N_per_m;
  report.stiffness_raw_N_per_m = state.approach.estimator.stiffness_raw_N_per_m;
  report.gamma = state.transition.gamma;
}

}  // namespace

/// What touches a module as the joints see it.
struct SeveralContacts::Place {
  PlacedContact at;
  ScaledVector a;  ///< J_p^T F^
};

SeveralContacts::SeveralContacts(const ControllerConfig& config,
                                 const ScaledVector& inv_sqrt_weights)
    : chain_(config.chain),
      task_size_(config.task.size),
      is_at_ends_(config.force_control->limit_at == LimitAt::kModuleEnds),
      inv_sqrt_weights_(inv_sqrt_weights),
      null_speed_limit_(config.chain, inv_sqrt_weights) {
  const double mu = config.force_control->friction_coefficient;
  const bool has_centre = !is_at_ends_ && config.force_control->limit_at != LimitAt::kResultant;
  for (const TactileModuleConfig& module : config.tactile_modules) {
    modules_.push_back({module.link, ApproachLimit(config, module), {}, {}, module.length_m});
    if (mu > 0.0) modules_.back().cone.emplace(module, mu);
    if (has_centre) modules_.back().centre.emplace(module, mu);
  }
}

SeveralContactsState SeveralContacts::initialState() const noexcept {
  SeveralContactsState state;
  for (std::size_t i = 0; i < modules_.size(); ++i)
    state.modules[i].approach = modules_[i].limit.initialState();
  return state;
}

void SeveralContacts::locate(const TaskKinematics& kinematics, const Module& module,
                             const ContactPointState& point, Place& place) const noexcept {
  place.at = placed(kinematics.pose, module.link, point);
  applyPointJacobianTranspose(chain_, kinematics.pose, module.link.joint, place.at.p_Base,
                              place.at.F_Base, place.a);
}

/// Without speed, damping and presence.
inline void SeveralContacts::project(const TaskKinematics& kinematics, const ScaledVector& a,
                                     SpeedRow& row) const noexcept {
  row.a_scaled = inv_sqrt_weights_.cwiseProduct(a);
  row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
}

void SeveralContacts::addRowAt(const TaskKinematics& kinematics, const Module& module,
                               ContactPointState point, double position_m,
                               SpeedRows& rows) const noexcept {
  point.position_m = position_m;
  Place place;
  locate(kinematics, module, point, place);
  project(kinematics, place.a, rows.row[rows.size++]);
}

/// Where rows stand: the resultant does not say where its contacts are. place: the resultant's.
inline void SeveralContacts::addPlaces(const TaskKinematics& kinematics, const Module& module,
                                       const ModuleContactState& state, const Place& place,
                                       SpeedRows& rows) const noexcept {
  const ContactPointState& contact = state.approach.smoother.contact;
  const double shift_m = state.centre.shift_m;
  if (module.cone) {
    const double x_m = contact.position_m;
    const CoverPart part =
        is_at_ends_
            ? CoverPart{0.0, module.length_m}
            : module.cone->around({x_m + std::min(0.0, shift_m), x_m + std::max(0.0, shift_m)});
    module.cone->add(chain_, kinematics, contact.direction, part, inv_sqrt_weights_, rows);
  } else if (is_at_ends_) {
    addRowAt(kinematics, module, contact, 0.0, rows);
    addRowAt(kinematics, module, contact, module.length_m, rows);
  } else {
    project(kinematics, place.a, rows.row[rows.size++]);
    if (shift_m != 0.0) addRowAt(kinematics, module, contact, contact.position_m + shift_m, rows);
  }
}

void SeveralContacts::sense(const Gains& gains, const TaskKinematics& kinematics,
                            const TactileReading& reading, const CommandedMotion& commanded,
                            double period_s, const Module& module, ModuleContactState& state,
                            Place& place) const noexcept {
  ContactPointState& contact = state.approach.smoother.contact;
  contact.interval_s = 0.0;
  if (reading.contact.isNew())
    module.limit.follow(gains.force, reading.contact, framePose(kinematics.pose, module.link),
                        state.approach);
  if (reading.is_lost) {
    contact.force_N = 0.0;
    state.approach.position = {};  // else all of its absence were one way to its next sample
    state.transition = {};         // so that the next contact is a new one
  }
  locate(kinematics, module, contact, place);
  const double F_p_N = contactForce_N(gains.force, state);
  const double share = fading(gains.force, F_p_N, place.at.p_Base, state);
  module.limit.observe(gains.force, place.a,
                       {F_p_N, share == 0.0 ? 1.0 : state.transition.gamma, share}, commanded.q,
                       period_s, state.approach);
  passTransition(gains.force.transition, F_p_N, place.at.p_Base, period_s, state.transition);
  if (!commanded.is_followed)
    state.approach.obstacle.v_m_per_s = state.approach.obstacle.high_s = 0.0;
  // Nor does the first force after a rest or a loss: nobody knows the way that led to it.
  const bool has_no_way = commanded.isAtRest() || reading.is_lost;
  const bool is_first = state.approach.rested_N_per_m != 0.0 && reading.contact.isNew();
  if (has_no_way || is_first) module.limit.rest(gains.force, F_p_N, state.approach);
  if (!has_no_way && is_first) state.approach.rested_N_per_m = 0.0;
  if (module.centre) {
    if (state.approach.memory_N_per_m == 0.0 || reading.is_lost)
      state.centre = {};
    else if (reading.contact.isNew())
      module.centre->update(gains.force, reading.contact, state.approach.smoother, state.centre);
  }
}

/// The second level's.
inline void SeveralContacts::addRow(const ForceGains& gains, const TaskKinematics& kinematics,
                                    const Module& module, const ModuleContactState& state,
                                    const Place& place, SpeedRows& rows) const noexcept {
  const int first = rows.size;
  addPlaces(kinematics, module, state, place, rows);
  module.limit.limitRows(gains, contactForce_N(gains, state), module.cosine(),
                         presence(gains, state.approach), state.approach, first, rows);
}

void SeveralContacts::addRows(const ForceGains& gains, const TaskKinematics& kinematics,
                              int without_module, const SeveralContactsState& state,
                              SpeedRows& rows) const noexcept {
  for (int i = 0; i < static_cast<int>(modules_.size()); ++i) {
    const ApproachLimitState& approach = state.modules[i].approach;
    if (i == without_module || approach.memory_N_per_m == 0.0) continue;
    Place place;
    locate(kinematics, modules_[i], approach.smoother.contact, place);
    addRow(gains, kinematics, modules_[i], state.modules[i], place, rows);
  }
}

/// The first level.
double SeveralContacts::holdInNullSpace(const ForceGains& gains, const SpeedRows& rows,
                                        const RowVector& v_hold, int contacts, RowProblem& problem,
                                        NullSpeedLimits& limits, Motion& motion) const noexcept {
  if (rows.size == 0) return 0.0;
  const RowMultipliers found = problem.solve(v_hold, kNullSpaceAlone, motion, kFirstShare);
  const RowVector& l = found.l;
  Motion push;
  push.y.setZero();
  push.v_scaled.setZero();
  tactus::addRows(rows, l, kNullSpaceAlone, push);
  const double share = null_speed_limit_.shareOnTop(gains, motion.v_scaled, push.v_scaled, limits);
  motion.v_scaled += share * push.v_scaled;
  motion.y += share * push.y;
  return share * l.head(contacts).sum();
}

void SeveralContacts::update(const Gains& gains, const TaskKinematics& kinematics,
                             const std::array<TactileReading, kMaxTactileModules>& readings,
                             const CommandedMotion& commanded, const MotionGate& gate,
                             double period_s, SeveralContactsState& state, ContactReport& report,
                             Motion& motion) const noexcept {
  SpeedRows rows;
  RowVector v_hold(kMaxRows);
  std::array<int, kMaxTactileModules + 1> first{};
  int leading = 0;
  double most_N = -1.0;
  for (int i = 0; i < static_cast<int>(modules_.size()); ++i) {
    Place place;
    ModuleContactState& contact = state.modules[i];
    const ApproachLimitState& approach = contact.approach;
    sense(gains, kinematics, readings[i], commanded, period_s, modules_[i], contact, place);
    if (approach.memory_N_per_m > 0.0) {
      addRow(gains.force, kinematics, modules_[i], contact, place, rows);
      addHoldSpeeds(gains.force, approach, modules_[i].cosine(), first[i], rows, v_hold);
    }
    first[i + 1] = rows.size;
    if (approach.smoother.contact.force_N <= most_N) continue;
    most_N = approach.smoother.contact.force_N;
    leading = i;
  }
  const int contacts = rows.size;
  gate.add(commanded, kinematics, 1.0, period_s, rows);
  for (int i = contacts; i < rows.size; ++i) v_hold[i] = rows.row[i].v_max_m_per_s;
  RowProblem problem(rows, task_size_);
  report.u_n =
      -holdInNullSpace(gains.force, rows, v_hold, contacts, problem, state.null_speed, motion);
  const RowVector l = problem.keep(motion);
  for (int i = 0; i < static_cast<int>(modules_.size()); ++i) {
    double sum = 0.0;
    for (int row = first[i]; row < first[i + 1]; ++row) sum += l[row];
    state.modules[i].approach.is_limiting = sum > 0.0;
    report.u_t -= sum;
  }
  tell(gains.force, state.modules[leading], report);
}

}  // namespace tactus
