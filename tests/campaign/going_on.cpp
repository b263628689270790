#include "campaign/going_on.h"

#include <fmt/format.h>

#include <algorithm>

#include "campaign/play.h"

namespace tactus::campaign {
namespace {

constexpr double kMaxPeakMore = 0.25;  ///< than without a trouble, m/s or rad/s

/// The peak where nothing went wrong: the same start, the line off from each stop to where the arm
/// goes on, and the same forces, those between only if asked for.
double undisturbedPeak(const Stage& stage, const Plan& plan, const std::vector<GoingOn>& stops,
                       bool has_forces_between, long long& cycles) {
  const GoingOn& last = stops.back();
  Plan forces = plan;
  std::erase_if(forces.injections, [](const Injection& x) { return !x.kind->is_followed; });
  Play play(stage, forces);
  double peak = 0.0;
  while (play.now_ms() <= last.end_ms) {
    const int t_ms = play.now_ms() + 1;  // when this cycle has been
    const bool is_stopped = std::any_of(stops.begin(), stops.end(), [t_ms](const GoingOn& stop) {
      return t_ms >= stop.stop_ms && t_ms < stop.return_ms;
    });
    CycleInput input;
    input.lines.enable = !is_stopped;
    play.setForces(!is_stopped || has_forces_between);
    play.step(input);
    ++cycles;
    if (t_ms < last.return_ms) continue;
    peak = std::max({peak, play.now().command.cwiseAbs().maxCoeff(),
                     play.now().velocity.cwiseAbs().maxCoeff()});
  }
  return peak;
}

}  // namespace

void compareGoingOn(const Stage& stage, const Plan& plan, const GoingOnJudge& judge,
                    std::vector<Violation>& found, long long& cycles) {
  for (std::size_t i = 0; i < judge.all.size(); ++i) {
    const GoingOn& one = judge.all[i];
    if (!judge.is_calm[i] || one.peak <= kMaxPeakMore) continue;
    const std::vector<GoingOn> stops(judge.all.begin(),
                                     judge.all.begin() + static_cast<long>(i) + 1);
    double peak = undisturbedPeak(stage, plan, stops, false, cycles);
    if (one.has_hand) peak = std::max(peak, undisturbedPeak(stage, plan, stops, true, cycles));
    if (one.peak <= peak + kMaxPeakMore) continue;
    found.push_back({"going on", "faster than undisturbed after a return to running",
                     fmt::format("{:.2f}, undisturbed {:.2f}", one.peak, peak), one.return_ms});
    return;
  }
}

void GoingOnJudge::look(const Look& look) {
  const Observation& now = look.now;
  const bool is_open = !all.empty() && all.back().end_ms == 0;
  const bool has_ended =
      is_open && (now.mode != Mode::kRunning || now.t_ms > all.back().return_ms + kWindow_ms);
  if (has_ended) all.back().end_ms = look.before.t_ms;
  if (now.mode != Mode::kRunning && look.before.mode == Mode::kRunning) stop_ms = now.t_ms;
  if (look.entered(Mode::kRunning) && stop_ms >= 0) {
    all.push_back({.stop_ms = stop_ms, .return_ms = now.t_ms});
    is_calm.push_back(true);
  }
  if (all.empty() || all.back().end_ms != 0) return;
  is_calm.back() = is_calm.back() && now.is_calm;
  all.back().has_hand = all.back().has_hand || now.has_hand;
  all.back().peak = std::max(
      {all.back().peak, now.command.cwiseAbs().maxCoeff(), now.velocity.cwiseAbs().maxCoeff()});
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
