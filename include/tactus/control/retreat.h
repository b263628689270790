#pragma once

#include "tactus/control/contact_point.h"
#include "tactus/math/types.h"

namespace tactus {

/// The longest way out; the deadline of the mode is the same.
inline constexpr double kMaxRetreat_s = 1.5;

/// What is known of a contact when the arm begins to leave it.
struct RetreatStart {
  double force_N = 0.0;            ///< the hardest push of late
  double stiffness_N_per_m = 0.0;  ///< the least that it may have
  double speed_m_per_s = 0.0;      ///< of the contact point along the push, at the fault
  double untold_s = 0.0;           ///< since the arm was where the last sample felt it
};

/// What the module says in a cycle.
struct RetreatReading {
  bool is_new = false;       ///< a sample has come
  bool is_readable = false;  ///< that one, or without one the last
  double age_s = 0.0, max_age_s = 0.0;
  double force_N = 0.0;
};

/// The way out of a contact. Its coordinate is that of the contact point along the push, m; or,
/// where nobody knows that, seconds of the way back.
struct RetreatState {
  bool is_under_way = false;  ///< the mode asks for it
  bool is_over = false;       ///< there is nothing to leave, or no more
  bool has_moved = false;     ///< away from the path, since the last restart
  bool is_felt = false;       ///< by samples since it began
  bool is_free = false;       ///< the last of them told of no contact
  bool has_push = false;      ///< point and direction are known
  bool is_placed = false;     ///< direction_Base is
  int module = -1;            ///< whose contact; -1: none is known

  ContactPointState push;                    ///< the contact, as that module said
  Vector3 direction_Base = Vector3::Zero();  ///< of the push, held
  JointVector velocity_at_fault;             ///< m/s or rad/s
  /// Of joint limits, when it first began: m/s or rad/s, scaled
  ScaledVector way_out = ScaledVector::Zero();
  double stiffness_N_per_m = 0.0;
  double untold_s = 0.0;
  ScaledVector row = ScaledVector::Zero();  ///< of the way: d way / dt = row^T q_dot

  double time_s = 0.0, free_s = 0.0;
  double way = 0.0;       ///< commanded so far; negative while the arm still brakes
  double way_to = 0.0;    ///< where it ends if nothing more is felt
  double speed = 0.0;     ///< that is asked for
  double marked_N = 0.0;  ///< the reading at the last mark
  double way_at_mark = 0.0;
};

// clang-format off: equations
/// An arm that stops in a contact leaves it, by the samples or, without them, by what was known:
///   v = min(a t, v_max),   a = 2 m/s^2,   v_max = 1 m/s felt, 0.25 m/s not
/// Felt, it goes on while F > F_th, and ends 0.2 s after that, or when 30 mm of way have not
/// lowered F by 1 N: such a sensor says nothing of a contact. Not felt, at
///   way = min(0.1 m, F / c + |v_0| t_0 + 20 mm)
/// with the hardest F of late, the least stiffness c, and the speed v_0 for the time t_0 since the
/// arm was where that sample felt it: also outwards, as a law that answers just now has gone on
/// before; until then v <= sqrt(2 a (way - way so far)). And after kMaxRetreat_s in any case.
// clang-format on
void startRetreat(const RetreatStart& start, RetreatState& state) noexcept;

/// For a contact that no sample has told of, if there is one: back the way it came, for so long.
void startWayBack(double duration_s, RetreatState& state) noexcept;

/// The speed along the way in this cycle, m/s or, on the way back, 1; 0 when it is over.
double retreatSpeed(const RetreatReading& reading, double contact_threshold_N, double period_s,
                    RetreatState& state) noexcept;

/// What was commanded for that time.
void goAway(const JointVector& velocity, double duration_s, RetreatState& state) noexcept;

}  // namespace tactus
