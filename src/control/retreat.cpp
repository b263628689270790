#include "tactus/control/retreat.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kAcceleration_m_per_s2 = 2.0;  ///< a
constexpr double kFeltSpeed_m_per_s = 1.0;      ///< v_max
constexpr double kBlindSpeed_m_per_s = 0.25;
constexpr double kMaxBlindWay_m = 0.1;
constexpr double kBlindMargin_m = 0.02;  ///< for what a law did since
/// Any contact that could press so hard answers sooner than that, also one that follows the arm.
constexpr double kWayToAnswer_m = 0.03;
constexpr double kAnswer_N = 1.0;
/// An obstacle that comes on is there again by then, and an arm that swings back.
constexpr double kFree_s = 0.2;

double blindWay_m(double force_N, double stiffness_N_per_m, double untold_m) noexcept {
  const double depth_m = force_N / stiffness_N_per_m;
  return std::min(kMaxBlindWay_m, depth_m + untold_m + kBlindMargin_m);
}

void mark(double force_N, RetreatState& state) noexcept {
  state.marked_N = force_N;
  state.way_at_mark = state.way;
}

/// What a sample says of the way that is left.
void feel(double force_N, double contact_threshold_N, RetreatState& state) noexcept {
  const bool was_free = state.is_free || state.marked_N == 0.0;
  state.is_free = force_N <= contact_threshold_N;
  if (state.is_free) return;
  if (was_free || force_N <= state.marked_N - kAnswer_N) mark(force_N, state);
  state.marked_N = std::max(state.marked_N, force_N);  // the filter tells late what braking took
  state.way_to = state.way + blindWay_m(force_N, state.stiffness_N_per_m, 0.0);
}

bool isAtEnd(const RetreatState& state) noexcept {
  if (state.time_s > kMaxRetreat_s) return true;
  if (state.is_free) return !state.is_felt || state.free_s > kFree_s;
  return state.way >= (state.is_felt ? state.way_at_mark + kWayToAnswer_m : state.way_to);
}

}  // namespace

void startRetreat(const RetreatStart& start, RetreatState& state) noexcept {
  state.stiffness_N_per_m = start.stiffness_N_per_m;
  state.way_to = blindWay_m(start.force_N, start.stiffness_N_per_m,
                            std::abs(start.speed_m_per_s) * start.untold_s);
  state.way = state.speed = 0.0;
}

void startWayBack(double duration_s, RetreatState& state) noexcept {
  state.way_to = duration_s;
  state.way = state.speed = 0.0;
}

double retreatSpeed(const RetreatReading& reading, double contact_threshold_N, double period_s,
                    RetreatState& state) noexcept {
  state.time_s += period_s;
  if (reading.is_new || reading.age_s > reading.max_age_s)
    state.is_felt = reading.is_new && reading.is_readable;
  if (reading.is_new && state.is_felt) feel(reading.force_N, contact_threshold_N, state);
  state.free_s = state.is_free ? state.free_s + period_s : 0.0;
  state.is_over = state.is_over || isAtEnd(state);
  if (state.is_over || state.is_free) return state.speed = 0.0;
  if (!state.has_push) return 1.0;
  double most = kFeltSpeed_m_per_s;
  if (!state.is_felt) {
    const double left_m = std::max(0.0, state.way_to - state.way);
    most = std::min(kBlindSpeed_m_per_s, std::sqrt(2.0 * kAcceleration_m_per_s2 * left_m));
  }
  state.speed = std::min(most, state.speed + kAcceleration_m_per_s2 * period_s);
  return state.speed;
}

void goAway(const JointVector& velocity, double duration_s, RetreatState& state) noexcept {
  state.way += duration_s * state.row.head(velocity.size()).dot(velocity);
}

}  // namespace tactus
