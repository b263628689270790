#include "tactus/supervisor/gain_change.h"

#include <algorithm>

#include "tactus/control/gain_ramp.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kLeastTrial_s = 4.0;  ///< of contact
constexpr double kTrialTimeConstants = 10.0;
constexpr double kBack_s = 0.1;  ///< faster, a link that swings is slower stopped
constexpr double kSwing = 0.1;   ///< of F_act
constexpr double kLosses_per_s = 4.0;
constexpr double kAtLimit = 0.5;
constexpr double kWindow_s = 1.0;   ///< of the figures
constexpr double kMemory_s = 10.0;  ///< of how they were before a change
constexpr double kMoreThanBefore = 1.3;
constexpr double kFree_s = 0.5;  ///< longer than a bounce

/// Slow at both ends: a force that follows its limit would overshoot where that stops at once.
double eased(double share) noexcept { return share * share * (3.0 - 2.0 * share); }

}  // namespace

GainChange::GainChange(const Gains& gains, double period_s) noexcept
    : period_s_(period_s),
      kept_(gains),
      from_(gains),
      to_(gains),
      gains_(gains),
      free_s_(kFree_s) {}

void GainChange::order(const GainOrder& order) noexcept {
  const bool brings_back = report_.trouble != GainTrouble::kNone && order.over >= report_.number;
  report_.number = order.number;
  if (brings_back) return;
  order_ = order;
  report_ = {
      .number = order.number, .kept_number = report_.kept_number, .state = GainState::kWaiting};
}

void GainChange::ramp(const Gains& to, double duration_s) noexcept {
  from_ = gains_;
  to_ = to;
  duration_s_ = duration_s;
  passed_s_ = 0.0;
}

void GainChange::update(const GainWatchInput& seen) noexcept {
  observe(seen);
  is_changing_ = false;
  switch (report_.state) {
    case GainState::kKept:
      return;
    case GainState::kWaiting:
      // A way that was begun goes on, or it would wait on half of it.
      if (mustWait() && !isSame(gains_, to_)) {
        if (isSame(to_, kept_) || !trips(seen)) advance(seen, GainState::kWaiting);
        return;
      }
      // Over others that are on trial, which are watched as before, their time once they are there.
      if (isSame(gains_, kept_) || (!trips(seen) && !(isSame(gains_, to_) && isOver()))) begin();
      return;
    case GainState::kRamping:
      if (!trips(seen)) advance(seen, GainState::kOnTrial);
      return;
    case GainState::kOnTrial:
      if (!trips(seen)) watch(seen);
      return;
    case GainState::kGoingBack:
      return advance(seen, GainState::kKept);
  }
}

bool GainChange::mustWait() const noexcept { return order_.waits_for_free && free_s_ < kFree_s; }

void GainChange::begin() noexcept {
  if (mustWait()) return;
  if (isSame(gains_, kept_)) before_ = largest_;  // it may have waited for hours
  ramp(order_.gains, gainRampDuration_s(gains_, order_.gains));
  contact_s_ = 0.0;
  for_s_ = order_.for_s;
  report_.state = GainState::kRamping;
}

void GainChange::advance(const GainWatchInput& seen, GainState next) noexcept {
  const bool must_go_back =
      report_.state == GainState::kGoingBack && report_.trouble != GainTrouble::kTimeIsOver;
  if (seen.is_held && is_in_contact_ && !must_go_back) return;
  passed_s_ += period_s_;
  is_changing_ = true;
  gains_ = gainsBetween(from_, to_, eased(std::min(1.0, passed_s_ / duration_s_)));
  if (passed_s_ < duration_s_) return;
  passed_s_ = 0.0;
  report_.state = next;
}

void GainChange::watch(const GainWatchInput& seen) noexcept {
  const bool is_tried = seen.is_running && (is_in_contact_ || !seen.can_feel);
  contact_s_ += is_tried ? period_s_ : 0.0;
  if (isOver()) return;
  const double trial_s = std::max(kLeastTrial_s, kTrialTimeConstants * to_.force.time_constant_s);
  if (for_s_ < kNoLimit || contact_s_ < trial_s) return;
  kept_ = to_;
  report_.state = GainState::kKept;
  report_.kept_number = report_.number;
}

bool GainChange::isOver() noexcept {
  passed_s_ += period_s_;
  if (passed_s_ < for_s_) return false;
  goBack(GainTrouble::kTimeIsOver, passed_s_, for_s_);
  return true;
}

double GainChange::wayBack_s(GainTrouble trouble) const noexcept {
  if (trouble == GainTrouble::kTimeIsOver) return gainRampDuration_s(gains_, kept_);
  return kBack_s;
}

void GainChange::goBack(GainTrouble trouble, double figure, double limit) noexcept {
  ramp(kept_, wayBack_s(trouble));
  report_.state = GainState::kGoingBack;
  report_.trouble = trouble;
  report_.figure = figure;
  report_.limit = limit;
}

double GainChange::leastSwing_N() const noexcept {
  return kSwing * std::max(kept_.force.activation_force_N, kept_.force.contact_threshold_N);
}

void GainChange::observe(const GainWatchInput& seen) noexcept {
  const ForceGains& force = gains_.force;
  swings_.update(seen.force_N, leastSwing_N(), period_s_);
  const bool was_in_contact = is_in_contact_;
  if (seen.force_N > force.contact_threshold_N) is_in_contact_ = true;
  if (seen.force_N <= std::min(force.transition.release_force_N, force.contact_threshold_N))
    is_in_contact_ = false;
  free_s_ = is_in_contact_ ? 0.0 : std::min(kFree_s, free_s_ + period_s_);
  const double share = period_s_ / kWindow_s;
  figures_.swing_N = swings_.swing_N();
  figures_.losses_per_s = flushed((1.0 - share) * figures_.losses_per_s);
  if (was_in_contact && !is_in_contact_) figures_.losses_per_s += 1.0 / kWindow_s;
  const double at_limit = is_in_contact_ && seen.is_at_limit ? 1.0 : 0.0;
  figures_.at_limit = flushed(figures_.at_limit + share * (at_limit - figures_.at_limit));
  const double left = 1.0 - period_s_ / kMemory_s;
  const auto remember = [left](double figure, double& largest) {
    largest = std::max(flushed(left * largest), figure);
  };
  remember(figures_.swing_N, largest_.swing_N);
  remember(figures_.losses_per_s, largest_.losses_per_s);
  remember(figures_.at_limit, largest_.at_limit);
}

bool GainChange::exceeds(GainTrouble trouble, double figure, double limit) noexcept {
  if (figure <= limit) return false;
  goBack(trouble, figure, limit);
  return true;
}

bool GainChange::trips(const GainWatchInput& seen) noexcept {
  if (seen.has_fault) {
    goBack(GainTrouble::kFault, 1.0, 0.0);
    return true;
  }
  const auto worse = [](double limit, double before) {
    return std::max(limit, kMoreThanBefore * before);
  };
  return exceeds(GainTrouble::kSwings, figures_.swing_N, worse(leastSwing_N(), before_.swing_N)) ||
         exceeds(GainTrouble::kLosses, figures_.losses_per_s,
                 worse(kLosses_per_s, before_.losses_per_s)) ||
         exceeds(GainTrouble::kAtLimits, figures_.at_limit, worse(kAtLimit, before_.at_limit));
}

}  // namespace tactus
