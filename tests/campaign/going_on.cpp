#include "campaign/going_on.h"

#include <fmt/format.h>

#include <algorithm>

#include "campaign/play.h"
#include "campaign/user.h"

namespace tactus::campaign {
namespace {

constexpr double kMaxPeakMore = 0.25;  ///< than without a trouble, m/s or rad/s
/// Where a hand leans on, which the arm is to give way to, in the posture in which it stands then.
constexpr double kMaxReturnMore = 0.5;
constexpr double kMaxHandMore = 0.5;
constexpr double kMaxHandShare = 0.25;
constexpr double kMaxHandRate = 0.5;  ///< m/s^2 or rad/s^2, while it leans on
constexpr int kBefore_ms = 200;

struct Peaks {
  double before = 0.0;  ///< the last stop, just
  double after = 0.0;   ///< in the time that is looked at
};

double speedOf(const Observation& now) {
  return std::max(now.command.cwiseAbs().maxCoeff(), now.velocity.cwiseAbs().maxCoeff());
}

/// The peaks where nothing went wrong: the same start, the line off from each stop to where the arm
/// goes on, and the same forces, those in the last stop only if asked for.
Peaks undisturbedPeaks(const Stage& stage, const Plan& plan, const std::vector<GoingOn>& stops,
                       bool has_forces_between, long long& cycles) {
  const GoingOn& last = stops.back();
  Plan forces = plan;
  std::erase_if(forces.injections, [](const Injection& x) { return !x.kind->is_followed; });
  Play play(stage, forces);
  Peaks peaks;
  while (play.now_ms() <= last.end_ms) {
    const int t_ms = play.now_ms() + 1;  // when this cycle has been
    const bool is_stopped = std::any_of(stops.begin(), stops.end(), [t_ms](const GoingOn& stop) {
      return t_ms >= stop.stop_ms && t_ms < stop.return_ms;
    });
    CycleInput input;
    input.lines.enable = !is_stopped;
    const bool is_last = t_ms >= last.stop_ms && t_ms < last.return_ms;
    play.setForces(!is_last || has_forces_between);
    play.step(input);
    ++cycles;
    const double speed = speedOf(play.now());
    const bool is_before = t_ms < last.stop_ms && t_ms >= last.stop_ms - kBefore_ms;
    if (is_before && !is_stopped) peaks.before = std::max(peaks.before, speed);
    if (t_ms >= last.return_ms) peaks.after = std::max(peaks.after, speed);
  }
  return peaks;
}

/// The peak after a hold where the line stays on: all that befell the arm before is the same.
double peakWithoutTheHold(const Stage& stage, const Plan& plan, const GoingOn& hold,
                          bool has_forces_between, long long& cycles) {
  Play play(stage, plan);
  User user(plan);
  double peak = 0.0;
  while (play.now_ms() <= hold.end_ms) {
    const int t_ms = play.now_ms() + 1;
    CycleInput input = play.input();
    if (!user.act(play.now_ms(), play.now().mode, input)) break;
    const bool is_hold = t_ms >= hold.stop_ms && t_ms <= hold.return_ms;
    if (is_hold) input.lines.enable = true;
    play.setForces(!is_hold || has_forces_between);
    play.step(input);
    ++cycles;
    if (t_ms >= hold.return_ms) peak = std::max(peak, speedOf(play.now()));
  }
  return peak;
}

/// What `one` may have come to, if the undisturbed run came to this.
double allowedPeak(const GoingOn& one, const Peaks& undisturbed) {
  const bool went_apart = one.before > undisturbed.before + kMaxPeakMore;
  const double peak = went_apart ? std::max(one.before, undisturbed.after) : undisturbed.after;
  const double way_back = one.has_retreated ? kMaxReturnMore : 0.0;
  return peak + way_back +
         (one.has_hand ? std::max(kMaxHandMore, kMaxHandShare * peak) : kMaxPeakMore);
}

double allowedPeak(const Stage& stage, const Plan& plan, const std::vector<GoingOn>& stops,
                   long long& cycles) {
  const GoingOn& one = stops.back();
  double allowed = allowedPeak(one, undisturbedPeaks(stage, plan, stops, false, cycles));
  if (one.peak > allowed && one.has_hand)
    allowed =
        std::max(allowed, allowedPeak(one, undisturbedPeaks(stage, plan, stops, true, cycles)));
  for (const bool has_forces : {false, true})
    if (one.peak > allowed && one.is_hold)
      allowed = std::max(allowed,
                         kMaxPeakMore + peakWithoutTheHold(stage, plan, one, has_forces, cycles));
  return allowed;
}

}  // namespace

void compareGoingOn(const Stage& stage, const Plan& plan, const GoingOnJudge& judge,
                    std::vector<Violation>& found, long long& cycles) {
  for (std::size_t i = 0; i < judge.all.size(); ++i) {
    const GoingOn& one = judge.all[i];
    if (!judge.is_calm[i] || one.peak <= kMaxPeakMore) continue;
    const std::vector<GoingOn> stops(judge.all.begin(),
                                     judge.all.begin() + static_cast<long>(i) + 1);
    const double allowed = allowedPeak(stage, plan, stops, cycles);
    if (one.peak <= allowed) continue;
    found.push_back({"going on", "faster than undisturbed after a return to running",
                     fmt::format("{:.2f}, allowed {:.2f}", one.peak, allowed), one.return_ms});
    return;
  }
}

void GoingOnJudge::look(const Look& look) {
  const Observation& now = look.now;
  const bool is_open = !all.empty() && all.back().end_ms == 0;
  const int since_ms = is_open ? now.t_ms - all.back().return_ms : 0;
  const bool is_let_go = look.before.has_hand && !now.has_hand && since_ms > kLeaned_ms;
  const bool has_ended =
      is_open && (now.mode != Mode::kRunning || since_ms > kWindow_ms || is_let_go);
  if (has_ended) all.back().end_ms = look.before.t_ms;
  const bool stops = now.mode != Mode::kRunning && look.before.mode == Mode::kRunning;
  if (stops) stop_ms = now.t_ms;
  has_retreated = (has_retreated && !stops) || now.mode == Mode::kRetreating;
  if (now.mode != Mode::kRunning)
    is_hold = (stops || is_hold) && now.mode == Mode::kHolding && now.fault == Fault::kNone;
  if (look.entered(Mode::kRunning) && stop_ms >= 0) {
    const double before = newest.empty() ? 0.0 : *std::ranges::max_element(newest);
    all.push_back({.stop_ms = stop_ms,
                   .return_ms = now.t_ms,
                   .before = before,
                   .is_hold = is_hold,
                   .has_retreated = has_retreated});
    is_calm.push_back(true);
    newest.clear();
  }
  if (now.mode == Mode::kRunning && now.is_calm) newest.push_back(speedOf(now));
  if (newest.size() > kBefore_ms) newest.pop_front();
  if (all.empty() || all.back().end_ms != 0) return;
  is_calm.back() = is_calm.back() && now.is_calm;
  all.back().has_hand = all.back().has_hand || now.has_hand;
  const double by_hand = now.has_hand ? kMaxHandRate * 1e-3 * (now.t_ms - all.back().return_ms) : 0;
  all.back().peak = std::max(all.back().peak, speedOf(now) - by_hand);
}

void GoingOnJudge::end(int now_ms) {
  if (!all.empty() && all.back().end_ms == 0) all.back().end_ms = now_ms;
}

double GoingOnJudge::peak() const {
  double peak = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (is_calm[i]) peak = std::max(peak, all[i].peak);
  return peak;
}

}  // namespace tactus::campaign
