#include "tactus/control/several_contacts.h"

#include <algorithm>

namespace tactus {
namespace {

static_assert(4 * kMaxTactileModules <= kMaxRows, "room for the corners of all contacts");

/// As gamma would be without an end: where the contact was, and still is felt.
double nearness(const ForceGains& gains, const ModuleContactState& state) noexcept {
  const double force_N = state.approach.smoother.contact.force_N;
  return force_N > gains.transition.release_force_N ? state.transition.gamma : 0.0;
}

double contactForce_N(const ForceGains& gains, const ModuleContactState& state) noexcept {
  return std::max(0.0, state.approach.smoother.contact.force_N - gains.contact_threshold_N);
}

/// 1 in contact, then less and less.
double presence(const ForceGains& gains, const ApproachLimitState& state) noexcept {
  const double in_contact =
      std::max(state.estimator.stiffness_N_per_m, gains.min_approach_stiffness_N_per_m);
  return std::min(1.0, state.memory_N_per_m / in_contact);
}

/// Of the first level.
void holdRow(const ForceGains& gains, const ApproachLimitState& state, SpeedRow& row) noexcept {
  const double m = state.memory_N_per_m;
  const double Tm = gains.time_constant_s * m;
  row.v_max_m_per_s =
      (gains.contact_threshold_N - state.smoother.contact.force_N - m * state.way_ahead_m) / Tm;
  row.damping_N_s_per_m = Tm;
  row.presence = presence(gains, state);
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
  Vector3 p_Base;  ///< of the resultant
  ScaledVector a;  ///< J_p^T F^ there
  /// Where there is a contact: rows without speed and damping, and what corners have to enclose.
  std::array<SpeedRow, 2> row;
  int rows = 0;
  CoverPart part;
};

SeveralContacts::SeveralContacts(const ControllerConfig& config,
                                 const ScaledVector& inv_sqrt_weights)
    : chain_(config.chain),
      task_size_(config.task.size),
      is_at_ends_(config.force_control->limit_at == LimitAt::kModuleEnds),
      inv_sqrt_weights_(inv_sqrt_weights),
      law_(*config.force_control, config.chain, inv_sqrt_weights) {
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
  const Pose& X_JointModule = module.link.X_JointFrame;
  const Vector3 p_JointContact = X_JointModule.p_AB + point.position_m * X_JointModule.R_AB.col(0);
  const Vector3 F_Joint = X_JointModule.R_AB.lazyProduct(point.direction);
  place.p_Base = pointInBase(kinematics.pose, module.link.joint, p_JointContact);
  const Vector3 F_Base = vectorInBase(kinematics.pose, module.link.joint, F_Joint);
  applyPointJacobianTranspose(chain_, kinematics.pose, module.link.joint, place.p_Base, F_Base,
                              place.a);
}

void SeveralContacts::addPlace(const TaskKinematics& kinematics, const ScaledVector& a,
                               Place& place) const noexcept {
  SpeedRow& row = place.row[place.rows++];
  row.a_scaled = inv_sqrt_weights_.cwiseProduct(a);
  row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
}

/// The resultant does not say where its contacts are.
void SeveralContacts::spread(const TaskKinematics& kinematics, const Module& module,
                             const ModuleContactState& state, Place& place) const noexcept {
  ContactPointState there = state.approach.smoother.contact;
  const auto addThere = [&](double position_m) {
    Place other;
    there.position_m = position_m;
    locate(kinematics, module, there, other);
    addPlace(kinematics, other.a, place);
  };
  if (is_at_ends_) {
    place.part = {0.0, module.length_m};
    addThere(place.part.from_m);
    addThere(place.part.to_m);
    return;
  }
  const double x_m = there.position_m;
  const double shift_m = state.centre.shift_m;
  place.part = {x_m + std::min(0.0, shift_m), x_m + std::max(0.0, shift_m)};
  if (module.cone) place.part = module.cone->around(place.part);
  addPlace(kinematics, place.a, place);
  if (shift_m != 0.0) addThere(x_m + shift_m);
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
  }
  locate(kinematics, module, contact, place);
  const double F_p_N = contactForce_N(gains.force, state);
  const double near = nearness(gains.force, state);
  module.limit.observe(gains.force, place.a, {F_p_N, near, 1.0 - near}, commanded.q, period_s,
                       state.approach);
  passTransition(gains.force.transition, F_p_N, place.p_Base, period_s, state.transition);
  if (!commanded.is_followed) state.approach.obstacle.high_s = 0.0;
  if (module.centre) {
    if (state.approach.memory_N_per_m == 0.0 || reading.is_lost)
      state.centre = {};
    else if (reading.contact.isNew())
      module.centre->update(gains.force, reading.contact, state.approach.smoother, state.centre);
  }
  if (state.approach.memory_N_per_m > 0.0) spread(kinematics, module, state, place);
}

/// The second level's.
void SeveralContacts::addRow(const ForceGains& gains, const TaskKinematics& kinematics,
                             const Module& module, const ModuleContactState& state,
                             const Place& place, SpeedRows& rows) const noexcept {
  const int first = rows.size;
  double cosine = 1.0;
  if (module.cone) {
    module.cone->add(chain_, kinematics, state.approach.smoother.contact.direction, place.part,
                     inv_sqrt_weights_, rows);
    cosine = module.cone->cosine();
  } else {
    for (int i = 0; i < place.rows; ++i) rows.row[rows.size++] = place.row[i];
  }
  module.limit.limitRows(gains, contactForce_N(gains, state), cosine, state.approach, first, rows);
  for (int i = first; i < rows.size; ++i) rows.row[i].presence = presence(gains, state.approach);
}

void SeveralContacts::addRows(const ForceGains& gains, const TaskKinematics& kinematics,
                              int without_module, const SeveralContactsState& state,
                              SpeedRows& rows) const noexcept {
  for (int i = 0; i < static_cast<int>(modules_.size()); ++i) {
    const ApproachLimitState& approach = state.modules[i].approach;
    if (i == without_module || approach.memory_N_per_m == 0.0) continue;
    Place place;
    locate(kinematics, modules_[i], approach.smoother.contact, place);
    spread(kinematics, modules_[i], state.modules[i], place);
    addRow(gains, kinematics, modules_[i], state.modules[i], place, rows);
  }
}

/// The first level.
double SeveralContacts::holdInNullSpace(const ForceGains& gains, const SpeedRows& rows,
                                        int contacts, NullSpeedLimits& limits,
                                        Motion& motion) const noexcept {
  if (contacts == 0) return 0.0;
  RowVector l = findMultipliers(rows, kNullSpaceAlone, task_size_, motion).l;
  ScaledVector v_scaled = ScaledVector::Zero();
  for (int i = 0; i < rows.size; ++i) v_scaled += l[i] * rows.row[i].a_scaled;
  l *= law_.speedShare(gains, v_scaled, limits);
  tactus::addRows(rows, l, kNullSpaceAlone, motion);
  return l.head(contacts).sum();
}

void SeveralContacts::update(const Gains& gains, const TaskKinematics& kinematics,
                             const std::array<TactileReading, kMaxTactileModules>& readings,
                             const CommandedMotion& commanded, const MotionGate& gate,
                             double period_s, SeveralContactsState& state, ContactReport& report,
                             Motion& motion) const noexcept {
  SpeedRows null_rows, rows;
  std::array<int, kMaxTactileModules + 1> first{};
  int leading = 0;
  double most_N = -1.0;
  for (int i = 0; i < static_cast<int>(modules_.size()); ++i) {
    Place place;
    ModuleContactState& contact = state.modules[i];
    const ApproachLimitState& approach = contact.approach;
    sense(gains, kinematics, readings[i], commanded, period_s, modules_[i], contact, place);
    if (approach.memory_N_per_m > 0.0) {
      for (int j = 0; j < place.rows; ++j) {
        null_rows.row[null_rows.size] = place.row[j];
        holdRow(gains.force, approach, null_rows.row[null_rows.size++]);
      }
      addRow(gains.force, kinematics, modules_[i], contact, place, rows);
    }
    first[i + 1] = rows.size;
    if (approach.smoother.contact.force_N <= most_N) continue;
    most_N = approach.smoother.contact.force_N;
    leading = i;
    motion.a = place.a;
  }
  const int contacts = null_rows.size;
  gate.add(commanded, kinematics, 1.0, period_s, null_rows);
  // Corners of many contacts may leave no room: what has none is still kept by the last gate.
  for (int i = contacts; i < null_rows.size && rows.size < kMaxRows; ++i)
    rows.row[rows.size++] = null_rows.row[i];
  report.u_n = -holdInNullSpace(gains.force, null_rows, contacts, state.null_speed, motion);
  const RowVector l = keepSpeedRows(rows, task_size_, motion);
  for (int i = 0; i < static_cast<int>(modules_.size()); ++i) {
    const double sum = l.segment(first[i], first[i + 1] - first[i]).sum();
    state.modules[i].approach.is_limiting = sum > 0.0;
    report.u_t -= sum;
  }
  tell(gains.force, state.modules[leading], report);
}

}  // namespace tactus
